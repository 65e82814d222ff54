"""Conversions between poses and ROS messages."""

import math
from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, Pose3, make_pose3, quaternion_of_yaw, yaw_of_quaternion
from ur_nodes.ports.validation import UNIT_SLACK
from ur_nodes.ports.values import NO_MATRIX

_PLANAR = (0, 1, 5)
_PLACES = [6 * row + column for row in _PLANAR for column in _PLANAR]
_NOTHING = [0.0] * 36


def numbers_of(matrix: NDArray[np.float64], others: float = 0.0) -> list[float]:
    """The 36 numbers of a message; `others` are the variances of height, roll and pitch."""
    if matrix is NO_MATRIX:
        return _NOTHING
    numbers = _NOTHING.copy()
    numbers[14] = numbers[21] = numbers[28] = others
    (numbers[0], numbers[1], numbers[5]), (numbers[6], numbers[7], numbers[11]), last = matrix.tolist()
    numbers[30], numbers[31], numbers[35] = last
    return numbers


def matrix_of(numbers: Sequence[float]) -> NDArray[np.float64]:
    """The matrix (3, 3) of a message."""
    return np.array([numbers[place] for place in _PLACES], dtype=np.float64).reshape(3, 3)


def pose_of_message(message: Pose) -> Pose2:
    """The planar part of a geometry_msgs/Pose."""
    q = message.orientation
    return Pose2(message.position.x, message.position.y, yaw_of_quaternion(q.x, q.y, q.z, q.w))


def checked_pose_of(message: Pose) -> Pose2:
    """As `pose_of_message`, with a yaw of NaN where the orientation is not a unit quaternion."""
    q = message.orientation
    pose = pose_of_message(message)
    return pose if abs(math.hypot(q.x, q.y, q.z, q.w) - 1.0) <= UNIT_SLACK else Pose2(pose.x, pose.y, math.nan)


def pose_message(pose: Pose2) -> Pose:
    """A geometry_msgs/Pose on the ground."""
    message = Pose()
    fill_pose(message, pose)
    return message


def fill_pose(message: Pose, pose: Pose2) -> None:
    """Make a geometry_msgs/Pose one on the ground, without new objects."""
    _fill(message.position, message.orientation, pose)


def pose3_of_transform(transform: Transform) -> Pose3:
    """Convert a geometry_msgs/Transform."""
    t, q = transform.translation, transform.rotation
    return make_pose3((t.x, t.y, t.z), (q.x, q.y, q.z, q.w))


def transform_message(pose: Pose2 | Pose3) -> Transform:
    """A geometry_msgs/Transform, on the ground or in space."""
    message = Transform()
    _fill(message.translation, message.rotation, pose)
    return message


def _fill(place: Point | Vector3, turn: Quaternion, pose: Pose2 | Pose3) -> None:
    if isinstance(pose, Pose2):
        place.x, place.y, place.z = pose.x, pose.y, 0.0
        turn.x, turn.y, turn.z, turn.w = quaternion_of_yaw(pose.yaw)
    else:
        place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = pose
