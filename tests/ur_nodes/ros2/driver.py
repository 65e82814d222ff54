"""Drives by plain commands as far as it gets, at most 0.3 m, rests, stops all, and prints what it saw as JSON.

The parameter `stamped` has it send TwistStamped on cmd_vel, and not Twist on key_vel.
"""

from __future__ import annotations

import json
import math
import sys

from ur_nodes.ports.node import Node, Timer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Odometry, Result, StampedTwist, Twist
from ur_nodes.run import run

_FAR = 0.3  # m
_LONG = 12.0  # s of commands: on a busy computer the mux takes few of them in time
_LONG_BLOCKED = 3.0  # s of commands that the emergency stop blocks
_PERIOD = 0.05  # s
_REST = 0.01  # m/s
_PATIENCE = 20.0  # s


class PlainDriver:
    """`stopped` is the state of the emergency stop that the mux had kept."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._stamped = node.parameters.boolean("stamped", False)
        topic, kind = ("cmd_vel", StampedTwist) if self._stamped else ("key_vel", Twist)
        self._commands = node.publish(topic, kind, Quality.COMMAND)
        self._stopped: bool | None = None
        self._first: Odometry | None = None
        self._newest: Odometry | None = None
        self._sent = 0
        node.subscribe("odom", Odometry, self._take)
        node.subscribe("cmd_vel_mux/stopped", bool, self._on_stopped, Quality.LATCHED)
        self._timer: Timer = node.every(_PERIOD, self._drive, steady=True)
        node.after(_PATIENCE, lambda: self._finish(Result(False, "it took too long")), steady=True)

    def _take(self, odometry: Odometry) -> None:
        self._first, self._newest = self._first or odometry, odometry

    def _on_stopped(self, stopped: bool) -> None:
        self._stopped = stopped if self._stopped is None else self._stopped

    def _drive(self) -> None:
        if self._first is None or self._stopped is None or not self._commands.subscribers():
            return
        longest = _LONG_BLOCKED if self._stopped else _LONG
        if self._moved() < _FAR and self._sent * _PERIOD < longest:
            twist = Twist(0.2, 0.0)
            self._commands.send(StampedTwist(0, "", twist) if self._stamped else twist)
            self._sent += 1
        elif self._newest is not None and abs(self._newest.twist.forward) < _REST:
            self._timer.cancel()
            self._node.call("cmd_vel_mux/stop", Trigger(), self._finish)

    def _moved(self) -> float:
        if self._first is None or self._newest is None:
            return 0.0
        return math.hypot(self._newest.pose.x - self._first.pose.x, self._newest.pose.y - self._first.pose.y)

    def _finish(self, answer: Result) -> None:
        found = {"stopped": self._stopped, "moved": self._moved(), "sent": self._sent, "answered": answer.success}
        sys.stdout.write(json.dumps(found) + "\n")
        sys.stdout.flush()
        self._node.end("done")


if __name__ == "__main__":
    sys.exit(run("driver", PlainDriver))
