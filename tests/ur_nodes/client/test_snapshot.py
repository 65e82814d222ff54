import math
from dataclasses import replace

import numpy as np
import pytest

from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot, distance_left, heading_there
from ur_nodes.geometry.pose import Pose2

DRIVING = RobotSnapshot(
    pose=Pose2(0.0, 0.0, 0.0),
    goal=GoalReport(1, Pose2(3.0, 4.0, 0.0), LastGoalState.DRIVING),
    path=np.array([[-1.0, 0.0], [0.0, 0.0], [3.0, 0.0], [3.0, 4.0]]),
)


def test_distance_left_is_along_the_path_from_the_robot_on() -> None:
    assert distance_left(DRIVING) == pytest.approx(7.0)


def test_distance_left_without_a_path_to_this_goal_is_straight() -> None:
    assert distance_left(replace(DRIVING, path=None)) == pytest.approx(5.0)
    assert distance_left(replace(DRIVING, path=np.array([[0.0, 0.0], [9.0, 9.0]]))) == pytest.approx(5.0)


def test_distance_left_needs_pose_and_goal() -> None:
    assert distance_left(replace(DRIVING, pose=None)) is None
    assert distance_left(replace(DRIVING, goal=GoalReport())) is None


def test_heading_without_an_angle_is_the_way_there() -> None:
    assert heading_there(DRIVING.pose, 0.0, 2.0) == pytest.approx(math.pi / 2)
    assert heading_there(Pose2(1.0, 1.0, 0.7), 1.0, 1.0) == 0.7
