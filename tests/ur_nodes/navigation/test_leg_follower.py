"""Legs of a path, driven by a kinematic robot."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.ur_nodes.navigation.closed_loop import LIMITS, LONG, ORIGIN, ClosedLoop, two_rooms

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.leg_follower import Driving, LegFollower, legs_back
from ur_nodes.navigation.navigator_step import Ending
from ur_nodes.navigation.planning.legs import Leg, legs_of_motions
from ur_nodes.navigation.planning.outline_motions import LEFT, RIGHT, MotionPose
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.rollout import FollowSettings, RolloutState

DRIVING = Driving(footprint_of_outline(LONG, 0.05), LIMITS, FollowSettings(), 0.1)
NOTHING = Costmap(np.zeros((200, 200), np.uint8), 0.05, Pose2(-5.0, -5.0, 0.0))


def line(start: tuple[float, float], end: tuple[float, float]) -> NDArray[np.float64]:
    return np.linspace(start, end, 1 + round(math.dist(start, end) / 0.05))


def drive(
    legs: tuple[Leg, ...], local: Costmap = NOTHING, start: Pose2 = ORIGIN, driving: Driving = DRIVING
) -> list[RolloutState]:
    """The states of a robot that follows legs until they end, or something blocks it."""
    follower, states = LegFollower(legs), [RolloutState(start, 0.0, 0.0)]
    for _ in range(400):
        state = states[-1]
        step = follower.step(state, LocalObstacles(local), ORIGIN, None, driving)
        if step.ended or step.command.blocked:
            return states
        v, w, left = step.command.velocity
        states.append(RolloutState(state.pose.compose(Pose2(v * 0.1, left * 0.1, w * 0.1)), v, w, left))
    raise AssertionError("the legs do not end")


def test_robot_turns_on_the_spot_between_legs_and_drives_back_where_a_leg_says_so() -> None:
    legs = (Leg(line((0.0, 0.0), (1.0, 0.0))), Leg(line((1.0, 0.0), (1.0, -0.6)), -1, math.pi / 2))
    states = drive(legs)
    end = states[-1].pose
    assert math.dist(end[:2], (1.0, -0.6)) < 0.05
    assert abs(wrap_angle(end.yaw - math.pi / 2)) < 0.1
    assert max(abs(state.pose.y) for state in states if state.speed > 0.1) < 0.02
    assert min(state.speed for state in states) == pytest.approx(-0.2, abs=0.01)


@pytest.mark.parametrize(("gear", "side"), [(LEFT, 1.0), (RIGHT, -1.0)])
def test_robot_drives_sideways_along_a_leg_with_its_heading_and_is_stopped_by_what_is_there(
    gear: int, side: float
) -> None:
    driving = replace(DRIVING, limits=replace(LIMITS, lateral=0.3))
    legs = (Leg(line((0.0, 0.0), (0.0, side)), gear, 0.0),)
    states = drive(legs, driving=driving)
    assert math.dist(states[-1].pose[:2], (0.0, side)) < 0.05
    assert max(abs(state.pose.yaw) for state in states) < 0.05
    assert max(side * state.left for state in states) == pytest.approx(0.3, abs=0.01)
    costs = NOTHING.costs.copy()
    rows = 100 + round(side * 16)
    costs[rows : rows + 2, 90:110] = LETHAL
    states = drive(legs, Costmap(costs, 0.05, NOTHING.origin), driving=driving)
    assert 0.05 < side * states[-1].pose.y < 0.8 - DRIVING.footprint.inscribed + 0.1


@pytest.mark.parametrize("turned", [2.6, 2.6 - math.tau])
def test_long_turn_is_made_in_the_direction_that_was_planned(turned: float) -> None:
    end = (math.cos(2.6), math.sin(2.6))
    states = drive((Leg(line((0.0, 0.0), end), 1, turned),))
    assert all(state.turn * turned >= 0.0 for state in states[:10])
    assert math.dist(states[-1].pose[:2], end) < 0.05


def test_turn_on_the_spot_that_would_touch_something_is_blocked() -> None:
    costs = NOTHING.costs.copy()
    costs[108:110, 100:110] = LETHAL  # beside the robot, in reach of its corners
    states = drive((Leg(line((0.0, 0.0), (0.0, 1.0)), 1, math.pi / 2),), Costmap(costs, 0.05, NOTHING.origin))
    assert abs(states[-1].pose.yaw) < 0.5


def test_path_without_a_length_ends_at_once_though_the_robot_is_a_little_beside_it() -> None:
    follower = LegFollower((Leg(np.array(((1.0, 1.0), (1.0, 1.0)))),))
    step = follower.step(RolloutState(Pose2(1.03, 1.0, 0.5), 0.0, 0.0), LocalObstacles(NOTHING), ORIGIN, None, DRIVING)
    assert step.ended
    assert step.away == pytest.approx(0.03)


def test_rest_begins_at_the_robot() -> None:
    follower = LegFollower((Leg(line((0.0, 0.0), (1.0, 0.0))), Leg(line((1.0, 0.0), (0.5, 0.0)), -1, 0.0)))
    assert len(follower.rest) == 32
    follower.step(RolloutState(Pose2(0.5, 0.0, 0.0), 0.5, 0.0), LocalObstacles(NOTHING), ORIGIN, None, DRIVING)
    assert follower.rest[0].tolist() == pytest.approx([0.5, 0.0])


@pytest.mark.parametrize("gear", [1, -1])
def test_short_bend_that_was_made_for_the_outline_ends_with_its_heading(gear: int) -> None:
    radius, turned = 0.38, 0.8
    angles = np.linspace(0.0, turned, 7)
    motions = [MotionPose(gear * radius * math.sin(a), radius * (1.0 - math.cos(a)), gear * a, gear) for a in angles]
    legs, _ = legs_of_motions(motions)
    end = drive(legs)[-1].pose
    assert math.dist(end[:2], motions[-1][:2]) < 0.03
    assert abs(wrap_angle(end.yaw - gear * turned)) < 0.12


def test_track_is_driven_back_for_a_distance() -> None:
    track = [Pose2(0.05 * step, 0.0, 0.0) for step in range(21)] + [Pose2(1.0, 0.0, 0.1 * n) for n in range(1, 4)]
    legs = legs_back(track, 0.5)
    assert [leg.gear for leg in legs] == [-1]
    states = drive(legs, start=track[-1])
    assert math.dist(states[-1].pose[:2], (0.5, 0.0)) < 0.05
    assert abs(states[-1].pose.yaw) < 0.06
    assert legs_back(track[:1], 0.5) == ()


def test_track_of_a_robot_that_drove_sideways_is_driven_sideways_back() -> None:
    track = [Pose2(0.0, 0.05 * step, 0.0) for step in range(21)]
    assert [leg.gear for leg in legs_back(track, 0.5, sideways=True)] == [RIGHT]


def test_long_robot_drives_through_a_door_beside_it() -> None:
    goal = Pose2(2.6, -0.9, 0.0)
    loop = ClosedLoop(two_rooms(), pose=Pose2(0.4, -1.0, 1.57), outline=LONG)
    drive = loop.drive(goal)
    assert (drive.ending, drive.touched) == (Ending.REACHED, False)
    assert math.dist(drive.pose[:2], goal[:2]) < 0.1
