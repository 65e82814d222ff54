"""The frames of the links of a description, from the positions of its joints. Pure."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ur.robot.description.pose import Pose, Vector
from ur.robot.description.urdf_parts import Description, Joint
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.values import Transform

_FIXED = "fixed"
_SLIDES = "prismatic"


def fixed_frames(description: Description, stamp: int) -> tuple[Transform, ...]:
    """The links that do not move in their parents."""
    return tuple(
        Transform(stamp, each.parent, each.child, _pose(each.pose), fixed=True)
        for each in description.joints
        if each.kind == _FIXED
    )


def moving_frames(description: Description, positions: Mapping[str, float], stamp: int) -> tuple[Transform, ...]:
    """The links on joints whose position (rad or m) is known."""
    return tuple(
        Transform(stamp, each.parent, each.child, _pose(each.pose).compose(_move(each, positions[each.name])))
        for each in description.joints
        if each.kind != _FIXED and each.name in positions
    )


def _move(joint: Joint, position: float) -> Pose3:
    x, y, z = _unit(joint.axis)
    if joint.kind == _SLIDES:
        return Pose3(x * position, y * position, z * position, 0.0, 0.0, 0.0, 1.0)
    sine = math.sin(position / 2)
    return Pose3(0.0, 0.0, 0.0, x * sine, y * sine, z * sine, math.cos(position / 2))


def _unit(axis: Vector) -> Vector:
    length = math.hypot(*axis)
    return (axis[0] / length, axis[1] / length, axis[2] / length) if length > 0.0 else (1.0, 0.0, 0.0)


def _pose(pose: Pose) -> Pose3:
    roll, pitch, yaw = (angle / 2 for angle in pose.angles())
    sr, cr, sp, cp, sy, cy = (f(each) for each in (roll, pitch, yaw) for f in (math.sin, math.cos))
    return Pose3(
        *pose.at,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
