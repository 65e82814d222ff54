"""Beams in a plane end where beams in space do."""

import dataclasses
import itertools
import math
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from ur.robot.base import Base
from ur.source.project import launch_library
from ur.worlds.world_file import Box, WorldModel, read_world
from ur_nodes.simulator.mujoco_model import build_model
from ur_nodes.simulator.sensors.flat_rays import LidarBeams, PlanarBeams, UprightShapes, find_visible, make_lidars
from ur_nodes.simulator.simulation import Simulation

BOXES = (Box("pillar", (3.0, 1.0, 0.5, 0.4), (0.3, 0.5, 1.0)), Box("low", (3.0, 0.0, 0.05, 0.0), (0.2, 0.2, 0.1)))
CART = Box("cart", (1.5, -1.0, 0.4, 0.7), (0.4, 0.3, 0.8), mass=20.0)


@pytest.fixture
def furnished(room: WorldModel) -> WorldModel:
    return dataclasses.replace(room, boxes=BOXES, obstacles=(CART,))


def both_scans(simulation: Simulation, base: Base, robot: int) -> tuple[np.ndarray, np.ndarray]:
    """The ranges of a robot's lidar without noise: as the simulation casts the beams, and in space."""
    assert base.lidar is not None
    physics, silence = simulation._physics, np.zeros(base.lidar.samples)
    in_space = LidarBeams(physics.model, base.lidar, robot)
    return simulation._lidars[robot].cast(physics.data, silence).copy(), in_space.cast(physics.data, silence)


def differing(some: np.ndarray, others: np.ndarray, tolerance: float) -> int:
    """The number of ranges that differ by more than a tolerance (m)."""
    return int(np.sum(~np.isclose(some, others, rtol=0.0, atol=tolerance)))


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (0.0, 1.2, 1.0), (2.0, -1.5, -2.5), (4.3, 0.4, math.pi)])
@pytest.mark.parametrize("sector", [(-math.pi, 3.12413936), (-2.0, 2.0), (0.0, 1.0)])
def test_ranges_in_a_plane_are_those_in_space(
    furnished: WorldModel, stage: Base, start: tuple[float, float, float], sector: tuple[float, float]
) -> None:
    assert stage.lidar is not None
    first, last = sector
    base = dataclasses.replace(stage, lidar=dataclasses.replace(stage.lidar, angle_min=first, angle_max=last))
    simulation = Simulation(furnished, base, start=start)
    flat, in_space = both_scans(simulation, base, 0)
    assert differing(flat, in_space, 1e-9) == 0


def test_robots_that_drive_see_one_another_as_in_space(
    furnished: WorldModel, stage: Base, drive: Callable[..., None]
) -> None:
    simulation = Simulation(furnished, stage, robots=3, start=(0.0, 0.0, 0.0))
    off = []
    for turn in range(12):
        for robot in range(3):
            simulation.command(robot, 0.5 if turn % 4 < 2 else -0.5, 1.0 - robot)
        drive(simulation, 0.3, 0.4 if turn % 2 else -0.4, 0.8)
        off += [differing(*both_scans(simulation, stage, robot), 0.01) for robot in range(3)]
    assert max(off) <= 2  # beams past an edge, while a robot that brakes dips
    assert sum(off) < 0.002 * len(off) * 360


def test_a_robot_that_rests_sees_others_drive_as_in_space(
    furnished: WorldModel, stage: Base, drive: Callable[..., None]
) -> None:
    simulation = Simulation(furnished, stage, robots=2, start=(0.0, 0.0, 0.0))
    drive(simulation, 1.0)
    scans = []
    for turn in range(8):
        drive(simulation, 0.2, -0.1, 0.4 if turn < 4 else 0.0, 1)
        flat, in_space = both_scans(simulation, stage, 0)
        assert differing(flat, in_space, 0.01) <= 2
        scans.append(flat)
    assert all(differing(then, now, 0.0) for then, now in itertools.pairwise(scans[1:]))


def test_an_obstacle_that_has_tipped_over_is_seen_as_in_space(furnished: WorldModel, stage: Base) -> None:
    simulation = Simulation(furnished, stage, start=(0.0, -1.0, 0.0))
    data = simulation._physics.data
    place = int(simulation._physics.model.joint("obstacle/cart").qposadr[0])
    before = both_scans(simulation, stage, 0)[0]
    data.qpos[place + 3 : place + 7] = (math.cos(0.4), 0.0, math.sin(0.4), 0.0)
    mujoco.mj_forward(simulation._physics.model, data)
    flat, in_space = both_scans(simulation, stage, 0)
    assert differing(flat, in_space, 0.0) == 0
    assert differing(flat, before, 0.02) > 0


def test_a_lidar_that_is_not_level_sees_in_space(furnished: WorldModel, stage: Base) -> None:
    assert stage.lidar is not None
    x, y, z, *_ = stage.lidar.pose
    lidar = dataclasses.replace(stage.lidar, pose=(x, y, z, 0.0, 0.2, 0.0))
    base = dataclasses.replace(stage, lidar=lidar)
    flat, in_space = both_scans(Simulation(furnished, base), base, 0)
    assert differing(flat, in_space, 0.0) == 0


@pytest.mark.parametrize(("top", "flat"), [(0.31, False), (0.29, False), (0.5, True), (0.2, True)])
def test_shapes_that_end_near_the_beams_are_not_flat(room: WorldModel, stage: Base, top: float, flat: bool) -> None:
    assert stage.lidar is not None
    world = dataclasses.replace(room, boxes=(Box("box", (2.0, 0.0, top / 2.0, 0.0), (0.5, 0.5, top)),))
    model = mujoco.MjModel.from_xml_string(build_model(world, stage, 1, (0.0, 0.0, 0.0)))
    assert UprightShapes(model, stage.lidar.pose[2]).flat is flat


def test_lidars_of_one_model_share_its_shapes(room: WorldModel, stage: Base) -> None:
    assert stage.lidar is not None
    model = mujoco.MjModel.from_xml_string(build_model(room, stage, 2, (0.0, 0.0, 0.0)))
    first, second = make_lidars(model, stage.lidar, 2)
    assert first._shapes is second._shapes


def test_sides_that_a_square_cannot_see_change_no_range(stage: Base) -> None:
    world = read_world(str(launch_library() / "n_simulator/worlds/maze.yaml"))
    model = mujoco.MjModel.from_xml_string(build_model(world, stage, 1, world.start))
    every, nothing = UprightShapes(model, 0.3)._fixed, np.zeros((4, 0))
    beams, others = (PlanarBeams(-math.pi, math.tau / 360, 360, 50.0) for _ in range(2))
    random, left = np.random.default_rng(0), []
    for middle in random.uniform((0.0, -6.0), (16.0, 6.0), (20, 2)).tolist():
        seen = every[:, find_visible(every, (middle[0], middle[1]), 0.25)]
        left.append(seen.shape[1])
        for dx, dy, yaw in random.uniform(-0.25, 0.25, (5, 3)).tolist():
            point = middle[0] + dx, middle[1] + dy
            assert np.array_equal(beams.cast(seen, nothing, point, yaw), others.cast(every, nothing, point, yaw))
    assert np.mean(left) < 0.3 * every.shape[1]
