"""Planar poses and ROS messages. A pose is (x, y, yaw): m, m, rad."""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3

from ur_nodes.rosio.pose import Pose2, wrap_angle

__all__ = [
    "Pose2",
    "pose_message",
    "pose_of_message",
    "pose_of_transform",
    "quaternion_of_yaw",
    "transform_message",
    "wrap_angle",
    "yaw_of_quaternion",
]


def quaternion_of_yaw(yaw: float) -> Quaternion:
    """A rotation about z."""
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def yaw_of_quaternion(q: Any) -> float:
    """The rotation about z of a (geometry_msgs) quaternion; 0 for the all-zero one that people send by mistake."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def pose_of_message(message: Pose) -> Pose2:
    """The planar part of a geometry_msgs/Pose."""
    return Pose2(message.position.x, message.position.y, yaw_of_quaternion(message.orientation))


def pose_message(pose: Pose2) -> Pose:
    """A geometry_msgs/Pose on the ground."""
    return Pose(Point(pose.x, pose.y, 0.0), quaternion_of_yaw(pose.yaw))


def pose_of_transform(transform: Transform) -> Pose2:
    """The planar part of a geometry_msgs/Transform."""
    return Pose2(transform.translation.x, transform.translation.y, yaw_of_quaternion(transform.rotation))


def transform_message(pose: Pose2) -> Transform:
    """A geometry_msgs/Transform on the ground."""
    return Transform(Vector3(pose.x, pose.y, 0.0), quaternion_of_yaw(pose.yaw))
