import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2, make_pose3, quaternion_of_yaw, wrap_angle, yaw_of_quaternion


def test_all_zero_rotation_counts_as_none() -> None:
    assert make_pose3((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 0.0)).planar() == (1.0, 2.0, 0.0)


@pytest.mark.parametrize("yaw", [-3.0, -0.5, 0.0, 1.0, 3.14])
def test_yaw_survives_a_quaternion(yaw: float) -> None:
    assert yaw_of_quaternion(*quaternion_of_yaw(yaw)) == pytest.approx(yaw)


def test_points_are_transformed_as_poses_are_composed() -> None:
    pose = Pose2(1.0, -2.0, 2.2)
    points = np.array([[[0.0, 0.0], [3.0, 1.0]]])
    moved = pose.transform_points(points)
    assert moved.shape == (1, 2, 2)
    assert moved[0, 1] == pytest.approx(pose.compose(Pose2(3.0, 1.0, 0.0))[:2])
    assert pose.inverse().transform_points(moved) == pytest.approx(points)


def test_angles_are_wrapped_one_by_one_and_in_arrays() -> None:
    angles = np.array([0.0, 4.0, -4.0, 7.0])
    assert wrap_angle(angles).tolist() == [wrap_angle(float(angle)) for angle in angles]
    assert wrap_angle(3.0 * math.pi) == pytest.approx(math.pi)
