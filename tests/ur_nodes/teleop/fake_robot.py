"""A robot that slides straight to its goals over a small empty map: for programs that send goals."""

import math
import sys

import numpy as np

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import GoalHandle
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, Path, Scan, StampedPose, Transform, Twist
from ur_nodes.run import run

STEP = 0.05  # s
SPEED = 4.0  # m/s
SIDE = 100  # cells of 0.1 m, the origin in the middle


class FakeRobot:
    """Its pose, and what it publishes."""

    def __init__(self, node: Node) -> None:
        self.pose = Pose2(0.0, 0.0, 0.0)
        self._node = node
        self._scan = node.publish("scan", Scan)
        self._plan = node.publish("move_base/NavfnROS/plan", Path)
        self._current = node.publish("move_base/current_goal", StampedPose, Quality.LATCHED)
        node.publish("map", Map, Quality.LATCHED).send(Map(0, "map", make_grid()))
        node.subscribe("cmd_vel", Twist, lambda _: None)
        self._goal: GoalHandle | None = None
        node.serve_goals("move_base", self)
        node.every(STEP, self._step)

    def handle_goal(self, handle: GoalHandle) -> None:
        """See GoalHandlers."""
        if self._goal is not None:
            self._goal.cancel("another goal took its place")
        target = handle.goal.target
        if max(abs(target.pose.x), abs(target.pose.y)) > SIDE * 0.05:
            handle.accept()
            handle.abort("the goal is off the map")
            return
        handle.accept()
        self._goal = handle
        self._current.send(target)
        poses = np.array([(pose.x, pose.y, pose.yaw) for pose in (self.pose, target.pose)])
        self._plan.send(Path(self._node.now(), "map", poses))

    def handle_cancel(self, handle: GoalHandle) -> None:
        """See GoalHandlers."""
        handle.cancel("cancelled")
        self._goal = None

    def _step(self) -> None:
        if self._goal is not None:
            self._move(self._goal, self._goal.goal.target.pose)
        now = self._node.now()
        links = [("map", "odom", Pose2(0.0, 0.0, 0.0)), ("odom", "base_footprint", self.pose)]
        links.append(("base_footprint", "laser", Pose2(0.1, 0.0, 0.0)))
        self._node.transforms.send(*(Transform(now, parent, child, pose.in_space()) for parent, child, pose in links))
        ranges = np.full(360, 1.5, np.float32)
        self._scan.send(Scan(now, "laser", -math.pi, math.pi / 180, 0.1, 10.0, ranges))

    def _move(self, goal: GoalHandle, target: Pose2) -> None:
        dx, dy = target.x - self.pose.x, target.y - self.pose.y
        left, step = math.hypot(dx, dy), SPEED * STEP
        if left <= step:
            self.pose, self._goal = target, None
            goal.succeed("Goal reached.")
        else:
            self.pose = Pose2(self.pose.x + dx / left * step, self.pose.y + dy / left * step, target.yaw)


def make_grid() -> Grid:
    """The map: walls all round."""
    cells = np.zeros((SIDE, SIDE), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return Grid(cells, 0.1, Pose2(-SIDE * 0.05, -SIDE * 0.05, 0.0))


if __name__ == "__main__":
    sys.exit(run("fake_robot", FakeRobot))
