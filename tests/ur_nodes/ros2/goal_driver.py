"""Sends the pose of a goal as RViz 2 does, and prints how it ended and where the robot is, as a line of JSON."""

from __future__ import annotations

import json
import math
import sys

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.geometry.pose import Pose2, make_pose3
from ur_nodes.ports.actions import GoalClient, GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Odometry, Path, PoseEstimate, StampedPose, Transform
from ur_nodes.run import run

_GOAL = Pose2(0.8, 0.4, 1.57)
_LOOK = 0.5  # s
_PATIENCE = 80.0  # s


class GoalDriver:
    """Mounts the lidar, since no robot_state_publisher runs, and sends the goal when the robot is localised."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._place: Pose2 | None = None
        self._localised = self._sent = False
        self._planned = 0
        lidar = load_base(str(launch_library()), "stage", "").lidar
        assert lidar is not None
        x, y, z, _, _, yaw = lidar.pose
        mount = make_pose3((x, y, z), (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)))
        node.transforms.send(Transform(0, "base_footprint", lidar.frame, mount, fixed=True))
        self._goals: GoalClient = node.follow_goals("move_base", self)
        self._poses = node.publish("goal_pose", StampedPose, Quality.EVERY)
        node.subscribe("base_pose_ground_truth", Odometry, self._take_place)
        node.subscribe("amcl_pose", PoseEstimate, self._on_estimate, Quality.LATCHED)
        node.subscribe("plan", Path, self._on_plan)
        node.every(_LOOK, self._send, steady=True)
        node.after(_PATIENCE, lambda: self._finish(f"no end within {_PATIENCE:g} s"), steady=True)

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        """See GoalFollower."""

    def on_goal_end(self, state: GoalState) -> None:
        """See GoalFollower."""
        self._finish(f"{state.state}: {state.text}")

    def _take_place(self, odometry: Odometry) -> None:
        self._place = odometry.pose

    def _on_estimate(self, _estimate: PoseEstimate) -> None:
        self._localised = True

    def _on_plan(self, path: Path) -> None:
        self._planned = len(path.poses)

    def _send(self) -> None:
        if not self._sent and self._localised and self._poses.subscribers() and self._goals.servers():
            self._sent = True
            self._poses.send(StampedPose(self._node.now(), "map", _GOAL))

    def _finish(self, end: str) -> None:
        sys.stdout.write(json.dumps({"end": end, "place": self._place, "planned": self._planned}) + "\n")
        sys.stdout.flush()
        self._node.end("done")


if __name__ == "__main__":
    sys.exit(run("goal_driver", GoalDriver))
