"""A stand-in for Nav2 and the robot's description: it turns the robot, and its localisation knows one place."""

import sys

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Transform, Twist
from ur_nodes.run import run

_PERIOD = 0.05  # s
_TOLERANCE = 1_000_000_000  # ns: for which amcl's transform holds


def start(node: Node) -> None:
    commands = node.publish("cmd_vel_nav2", StampedTwist, Quality.COMMAND)

    lidar = load_base(launch_library(), "stage").lidar
    assert lidar
    mount = Pose2(lidar.pose[0], lidar.pose[1], lidar.pose[5]).in_space()

    def send() -> None:
        commands.send(StampedTwist(node.now(), "", Twist(0.0, 0.5)))
        node.transforms.send(Transform(node.now() + _TOLERANCE, "map", "odom", Pose2(0.0, 0.0, 0.0).in_space()))

        node.transforms.send(Transform(node.now(), "base_footprint", lidar.frame, mount))

    node.every(_PERIOD, send, steady=True)


if __name__ == "__main__":
    sys.exit(run("controller_server", start))
