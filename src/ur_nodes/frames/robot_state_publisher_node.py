"""The node `robot_state_publisher`, for computers without upstream's: its parameters, topics and frames."""

import math
import sys
from collections.abc import Mapping

from ur.robot.description.parse import parse_urdf
from ur.robot.description.pose import Pose
from ur.robot.description.urdf_parts import Description, Joint
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Joints, Transform
from ur_nodes.run import run

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
    axis = joint.axis
    length = math.hypot(*axis)
    x, y, z = (axis[0] / length, axis[1] / length, axis[2] / length) if length > 0.0 else (1.0, 0.0, 0.0)
    if joint.kind == _SLIDES:
        return Pose3(x * position, y * position, z * position, 0.0, 0.0, 0.0, 1.0)
    sine = math.sin(position / 2)
    return Pose3(0.0, 0.0, 0.0, x * sine, y * sine, z * sine, math.cos(position / 2))


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


_FREQUENCY = 20.0  # Hz, upstream's default
_SECOND = 1_000_000_000


class RobotStatePublisher:
    """Sends the fixed frames once, and the moving ones with joint states, at most `~publish_frequency` times a second.

    ROS 2 has `robot_description` as a parameter of this node, and others find it on the topic of that name.
    """

    def __init__(self, node: Node) -> None:
        """Raises UserError: no description, or one that is no URDF."""
        text = node.parameters.text("robot_description")
        self._node = node
        self._description = parse_urdf(text, "robot_description")
        self._period = int(_SECOND / node.parameters.number("publish_frequency", _FREQUENCY, minimum=0.1))
        self._sent = 0
        self._transforms = node.transforms
        node.publish("robot_description", str, Quality.LATCHED).send(text)
        self._transforms.send(*fixed_frames(self._description, node.now()))
        node.subscribe("joint_states", Joints, self._on_joints)

    def _on_joints(self, joints: Joints) -> None:
        if 0 <= joints.stamp - self._sent < self._period:
            return
        self._sent = joints.stamp
        positions = dict(zip(joints.names, joints.angles, strict=False))
        if frames := moving_frames(self._description, positions, joints.stamp):
            self._transforms.send(*frames)


if __name__ == "__main__":
    sys.exit(run("robot_state_publisher", RobotStatePublisher))
