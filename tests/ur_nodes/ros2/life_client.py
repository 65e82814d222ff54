"""A client of a robot on ROS 2: sends a goal, obeys lines on its input, and prints what it sees ten times a second.

    life_client.py watch | drive X Y YAW

Lines: `cancel` and `stop` (the emergency stop). Printed are the base's speed (m/s, or rad/s where that is larger), None
before the first, and the state of the goal.
"""

from __future__ import annotations

import json
import math
import sys
import threading

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.geometry.pose import Pose2, make_pose3
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Odometry, PoseEstimate, Transform
from ur_nodes.run import run

_BEAT = 0.1  # s


class LifeClient:
    """The one that watches mounts the lidar, since no robot_state_publisher runs."""

    def __init__(self, node: Node, goal: Pose2 | None) -> None:
        self._node, self._goal = node, goal
        self._speed: float | None = None
        self._localised = self._sent = False
        if goal is None:
            lidar = load_base(str(launch_library()), "stage", "").lidar
            assert lidar is not None
            x, y, z, _, _, yaw = lidar.pose
            mount = make_pose3((x, y, z), (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)))
            node.transforms.send(Transform(0, "base_footprint", lidar.frame, mount, fixed=True))
        self._topics = NavigationTopics(node, Names())
        node.subscribe("base_pose_ground_truth", Odometry, self._take_place)
        node.subscribe("amcl_pose", PoseEstimate, self._on_estimate, Quality.LATCHED)
        node.every(_BEAT, self._beat, steady=True)
        threading.Thread(target=self._read, daemon=True).start()

    def _take_place(self, odometry: Odometry) -> None:
        twist = odometry.twist
        self._speed = max(math.hypot(twist.forward, twist.left), abs(twist.turn))

    def _on_estimate(self, _estimate: PoseEstimate) -> None:
        self._localised = True

    def _beat(self) -> None:
        if self._goal is not None and not self._sent and self._localised and not self._topics.snapshot().missing:
            self._sent = True
            self._topics.send_goal(f"{self._node.name}-goal", self._goal)
        sys.stdout.write(json.dumps({"speed": self._speed, "goal": self._topics.goal().state.value}) + "\n")
        sys.stdout.flush()

    def _read(self) -> None:
        for line in sys.stdin:
            self._node.post(self._topics.cancel_goals if line == "cancel\n" else self._stop)

    def _stop(self) -> None:
        self._node.call("cmd_vel_mux/stop", Trigger(), lambda _result: None)


def start(node: Node) -> LifeClient:
    numbers = [float(each) for each in sys.argv[2:5]] if sys.argv[1] == "drive" else None
    return LifeClient(node, Pose2(*numbers) if numbers else None)


if __name__ == "__main__":
    sys.exit(run("life_client", start))
