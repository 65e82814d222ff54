import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.geometry.pose import Pose2, make_pose3
from ur_nodes.geometry.rigid import (
    angle_between,
    from_angles,
    from_planar,
    from_pose,
    invert,
    to_angles,
    to_planar,
    to_quaternion,
)

turns = st.tuples(*[st.floats(-math.pi, math.pi)] * 3)
places = st.tuples(*[st.floats(-50, 50)] * 3)


@given(places, turns)
def test_quaternion_and_angles_give_the_same_transform_back(
    place: tuple[float, ...], angles: tuple[float, ...]
) -> None:
    pose = from_angles(place, angles)
    assert np.allclose(from_pose(make_pose3((place[0], place[1], place[2]), to_quaternion(pose))), pose, atol=1e-9)
    assert np.allclose(from_angles(place, to_angles(pose)), pose, atol=1e-6)
    assert to_quaternion(pose)[3] >= 0.0


@given(places, turns)
def test_inverse_undoes_a_transform(place: tuple[float, ...], angles: tuple[float, ...]) -> None:
    pose = from_angles(place, angles)
    assert np.allclose(pose @ invert(pose), np.eye(4), atol=1e-9)


def test_angles_are_about_fixed_axes_as_in_urdf() -> None:
    pose = from_angles((0.0, 0.0, 0.0), (math.pi / 2, 0.0, math.pi / 2))
    assert np.allclose(pose[:3, 2], [1.0, 0.0, 0.0])  # z was laid down by the roll and then turned by the yaw


def test_planar_pose_survives_the_way_through_space() -> None:
    pose = to_planar(from_planar(Pose2(1.0, -2.0, 2.5)))
    assert np.allclose(pose, (1.0, -2.0, 2.5))
    assert math.isclose(angle_between(from_planar(Pose2(0, 0, 0.4)), from_planar(Pose2(3, 1, -0.3))), 0.7)
