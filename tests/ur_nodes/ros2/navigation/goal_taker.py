"""A node of ours that offers `navigate_to_pose`: it reports three places, and arrives.

It refuses goals behind x = -10, gives up those behind x = -5, and takes its time with those beyond x = 5.
"""

from __future__ import annotations

import sys

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import GoalHandle
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import StampedPose
from ur_nodes.run import run

_BEAT = 0.05  # s


class GoalTaker:
    def __init__(self, node: Node) -> None:
        self._node = node
        self._handle: GoalHandle | None = None
        self._beats = 0
        node.serve_goals("move_base", self)
        node.every(_BEAT, self._beat)

    def handle_goal(self, handle: GoalHandle) -> None:
        """See GoalHandlers."""
        old, self._handle = self._handle, None
        if old is not None:
            old.cancel("a new goal has replaced this one")
        if handle.goal.target.pose.x < -10.0:
            handle.refuse("too far behind")
            return
        handle.accept()
        self._handle, self._beats = handle, 0

    def handle_cancel(self, handle: GoalHandle) -> None:
        """See GoalHandlers."""
        self._handle = None
        handle.cancel("cancelled")

    def _beat(self) -> None:
        handle = self._handle
        if handle is None:
            return
        self._beats += 1
        aim = handle.goal.target
        handle.report(StampedPose(self._node.now(), "map", Pose2(aim.pose.x * self._beats / 3.0, 0.0, 0.0)))
        if self._beats == 3 and aim.pose.x <= 5.0:
            self._handle = None
            if aim.pose.x < -5.0:
                handle.abort("there is a wall")
            else:
                handle.succeed("goal reached")


if __name__ == "__main__":
    sys.exit(run("move_base", GoalTaker))
