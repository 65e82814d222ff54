"""People of a simulated world: they walk on free floor, give way to robots, and are seen and touched."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from ur.robot.base import Base
from ur.source.diagnostic import UserError
from ur.worlds.world_file import Box, WorldModel
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.simulator.mujoco_model import PERSON_RADIUS
from ur_nodes.simulator.people.pedestrians import NearbyRobot, Pedestrians
from ur_nodes.simulator.people.strike import Strikes
from ur_nodes.simulator.simulation import Simulation

HERE = Pose2(0.0, 0.0, 0.0)


def walks(simulation: Simulation, seconds: float) -> np.ndarray:
    """The places (t, n, 2) of people at the odometry's rate."""
    places = []
    while simulation.time < seconds:
        if "odometry" in simulation.advance().due:
            places.append(simulation.people[:, :2])
    return np.array(places)


def test_people_walk_where_they_fit_and_at_the_speed_of_people(room: WorldModel, stage: Base) -> None:
    table = Box("table", (3.0, 0.0, 0.7, 0.3), (1.0, 0.6, 0.05))
    simulation = Simulation(replace(room, people=4, boxes=(table,)), stage, seed=3)
    places = walks(simulation, 60.0)
    assert (np.abs(places - (2.0, 0.0)) < np.array((3.0, 2.0)) - PERSON_RADIUS).all()
    inside = np.abs((places - (3.0, 0.0)) @ np.array(((math.cos(0.3), -math.sin(0.3)), (math.sin(0.3), math.cos(0.3)))))
    assert not ((inside < (0.5, 0.3)).all(axis=-1)).any()
    steps = np.hypot(*np.moveaxis(np.diff(places[::30], axis=0), -1, 0))  # of a second
    assert (steps.sum(axis=0) > 5.0).all()
    assert steps.max() < 1.25


def test_people_stop_on_their_way(room: WorldModel, stage: Base) -> None:
    places = walks(Simulation(replace(room, people=2), stage, seed=1), 60.0)
    still = (np.abs(np.diff(places, axis=0)) < 1e-9).all(axis=-1)
    assert (still.mean(axis=0) > 0.1).all()
    assert (still.mean(axis=0) < 0.9).all()


def test_the_same_seed_gives_the_same_walks_also_after_a_reset(room: WorldModel, stage: Base) -> None:
    world = replace(room, people=3)
    simulation = Simulation(world, stage, seed=5)
    first = walks(simulation, 10.0)
    simulation.reset()
    again = walks(simulation, 20.0)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, walks(Simulation(world, stage, seed=6), 10.0))


def test_people_do_not_change_the_noise_of_sensors(room: WorldModel, stage: Base) -> None:
    empty, full = (Simulation(replace(room, people=people), stage, seed=2) for people in (0, 3))
    while empty.time < 1.0:
        empty.advance()
        full.advance()
    differences = np.abs(empty.scan(0) - full.scan(0))
    assert (differences == 0.0).any()
    assert (differences > 0.3).any()


def test_people_do_not_walk_into_a_robot_at_rest(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(replace(room, people=6), stage, seed=4, start=(2.0, 0.0, 0.0))
    hull = hull_of_outline(stage.footprint)
    places = walks(simulation, 120.0).reshape(-1, 2)
    gaps = hull.distances(simulation.pose(0).inverse().transform_points(places)) - PERSON_RADIUS
    assert gaps.min() > 0.3
    assert simulation.collisions == (0,)


def test_one_who_stands_in_the_way_leaves_when_a_robot_waits(room: WorldModel, stage: Base) -> None:
    crowd = Pedestrians(replace(room, people=1), 0, [])
    crowd._people[0].until = 1000.0
    crowd.places[0] = (2.0, 0.0)
    robot = NearbyRobot(hull_of_outline(stage.footprint), Pose2(1.0, 0.0, 0.0), 0.0, 0.0)
    for step in range(100):
        crowd.decide(0.1 * step, [robot])
        crowd.advance(0.1)
    assert math.dist(crowd.places[0], (1.0, 0.0)) > 1.3


def test_one_who_cannot_leave_steps_aside(room: WorldModel, stage: Base) -> None:
    crowd = Pedestrians(replace(room, people=1), 0, [])
    crowd._people[0].until = 1000.0
    crowd.places[0] = (4.6, 0.1)
    robot = NearbyRobot(hull_of_outline(stage.footprint), Pose2(4.0, 0.0, 0.0), 0.0, 0.0)
    gaps = []
    for step in range(100):
        crowd.decide(0.1 * step, [robot])
        crowd.advance(0.1)
        gaps.append(float(robot.hull.distances(robot.pose.inverse().transform_points(crowd.places))[0]))
    assert max(gaps) > gaps[0] + 0.3
    assert min(gaps) > gaps[0] - 0.1


def test_a_robot_that_drives_on_strikes_a_person_and_one_at_rest_does_not(
    room: WorldModel, stage: Base, drive: Callable[..., None]
) -> None:
    simulation = Simulation(replace(room, people=1), stage, seed=0, start=(0.0, 0.0, 0.0))
    assert simulation._crowd is not None
    simulation._crowd._next = math.inf  # the person stays
    simulation._crowd.places[0] = (1.5, 0.0)
    drive(simulation, 4.0, 0.4)
    assert simulation.strikes == (1,)
    assert simulation.collisions == (1,)
    drive(simulation, 1.0, -0.3)
    drive(simulation, 1.0)
    simulation._crowd.velocities[0] = (-0.8, 0.0)
    drive(simulation, 0.5)
    assert simulation.strikes == (1,)
    assert simulation.collisions == (2,)


def test_a_turn_away_is_no_strike() -> None:
    strikes = Strikes(1)
    strikes.notice(0, HERE, (-0.3, 0.0, 0.0), [np.array((0.4, 0.0))], 1.0)
    strikes.notice(0, HERE, (0.0, 0.0, 1.0), [np.array((0.4, 0.0))], 2.0)
    assert strikes.counts == (0,)
    strikes.notice(0, HERE, (0.3, 0.0, 0.0), [np.array((0.4, 0.0))], 3.0)
    assert strikes.counts == (1,)


def test_a_world_file_names_the_people(make_world: Callable[[str], WorldModel]) -> None:
    assert make_world("people: 6\n").people == 6
    with pytest.raises(UserError, match="at most 50"):
        make_world("people: 51\n")


def test_a_world_without_floor_for_people_is_refused(room: WorldModel, stage: Base) -> None:
    full = Box("block", (2.0, 0.0, 0.9, 0.0), (6.0, 4.0, 0.1))
    with pytest.raises(UserError, match="people"):
        Simulation(replace(room, people=1, boxes=(full,)), stage)
