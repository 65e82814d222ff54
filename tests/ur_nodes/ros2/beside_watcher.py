"""Prints as JSON when the simulated robot turns, or is at rest (`wait`).

Before that it carries it to `x`, `y`, or with `home` to where odometry says that it is.
"""

import json
import sys

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Place
from ur_nodes.ports.values import Odometry, Result, StampedTwist
from ur_nodes.run import run

_PATIENCE = 40.0  # s
_LONG = 40  # readings of odometry in a row
_STILL, _TURNING = 0.01, 0.2  # rad/s


class Watcher:
    def __init__(self, node: Node) -> None:
        self._node = node
        own = node.parameters
        self._wait = own.text("wait", choices=("rest", "turning"))
        self._run = self._sent = 0
        self._lost = ""
        self._pose = Pose2(own.number("x"), own.number("y"), 0.0) if own.has("x") else None
        self._odometry: Pose2 | None = None
        self._placed = self._pose is None and not own.boolean("home", False)
        node.every(1.0, self._place)
        node.subscribe("odom", Odometry, self._on_odometry)
        node.subscribe("cmd_vel_nav2", StampedTwist, self._count)
        node.subscribe("lost_detector/lost_text", str, self._on_lost, Quality.LATCHED)
        node.after(_PATIENCE, self._finish, steady=True)

    def _place(self) -> None:
        pose = self._pose or self._odometry
        if pose and not self._placed:
            self._node.call("simulator/place", Place("robot", "map", pose), self._on)

    def _on(self, answer: Result) -> None:
        self._placed = answer.success

    def _on_lost(self, text: str) -> None:
        self._lost = text

    def _count(self, _command: StampedTwist) -> None:
        self._sent += self._run > 0

    def _on_odometry(self, odometry: Odometry) -> None:
        self._odometry = odometry.pose
        turn = abs(odometry.twist.turn)
        fits = turn < _STILL if self._wait == "rest" else turn > _TURNING
        self._run = self._run + 1 if fits and self._placed else 0
        self._sent *= self._run > 0
        if self._run == _LONG:
            self._finish()

    def _finish(self) -> None:
        found = {"seen": self._run >= _LONG, "sent": self._sent, "lost": self._lost}
        sys.stdout.write(json.dumps(found) + "\n")
        sys.stdout.flush()
        self._node.end("done")


if __name__ == "__main__":
    sys.exit(run("watcher", Watcher))
