"""The node `robot_state_publisher`, for computers without upstream's: its parameters, topics and frames."""

from __future__ import annotations

import sys

from ur.robot.description.parse import parse_urdf
from ur_nodes.frames.links import fixed_frames, moving_frames
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Joints
from ur_nodes.run import run

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
        node.subscribe("joint_states", Joints, self._take)

    def _take(self, joints: Joints) -> None:
        if 0 <= joints.stamp - self._sent < self._period:
            return
        self._sent = joints.stamp
        positions = dict(zip(joints.names, joints.angles, strict=False))
        if frames := moving_frames(self._description, positions, joints.stamp):
            self._transforms.send(*frames)


if __name__ == "__main__":
    sys.exit(run("robot_state_publisher", RobotStatePublisher))
