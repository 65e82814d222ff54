"""Conversions between poses and ROS messages."""

from __future__ import annotations

import math

from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3

from ur_nodes.geometry.pose import Pose2, Pose3, make_pose3, quaternion_of_yaw, yaw_of_quaternion
from ur_nodes.ports.validation import UNIT_SLACK


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
    fill_transform(message, pose)
    return message


def fill_transform(message: Transform, pose: Pose2 | Pose3) -> None:
    """Make a geometry_msgs/Transform that of a pose, without new objects."""
    _fill(message.translation, message.rotation, pose)


def _fill(place: Point | Vector3, turn: Quaternion, pose: Pose2 | Pose3) -> None:
    if isinstance(pose, Pose2):
        place.x, place.y, place.z = pose.x, pose.y, 0.0
        turn.x, turn.y, turn.z, turn.w = quaternion_of_yaw(pose.yaw)
    else:
        place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = pose
