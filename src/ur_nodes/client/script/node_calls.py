"""Calls from a program's thread on the thread of its node: waiting for their results, and their errors."""

import math
from collections.abc import Callable

from ur_nodes.client.navigation import WatchedWait
from ur_nodes.ports.node import Node


class RobotError(Exception):
    """A request was not carried out; the text is the reason, for users."""


class Refused(RobotError):  # noqa: N818 - named as users say it
    """The robot refuses: there is no path, the emergency stop is on, another client drives, or a sensor is missing."""


class Lost(RobotError):  # noqa: N818
    """Nothing is received from the robot, or from a node that the request needs."""


class TakenOver(RobotError):  # noqa: N818
    """Another client has taken over and drives the robot now."""


class Interrupted(RobotError):  # noqa: N818
    """The call was cancelled from another thread or task, and the motion that it had begun is stopped."""


def check_finite(**numbers: float) -> None:
    """Raise ValueError if a number is not finite."""
    for name, value in numbers.items():
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value}, expected a finite number")


_CALL_LIMIT = 2.0  # s


class NodeCalls:
    """Waits for the node of a program. One thread may use it; `interrupt` and `note_end` may come from any thread."""

    def __init__(self, node: Node, wait: WatchedWait) -> None:
        self.node = node
        self._wait = wait
        self._ended = self._interrupted = False

    def note_end(self) -> None:
        """Note that the node has ended, which ends all waiting."""
        self._ended = True

    def interrupt(self) -> None:
        """Let the waiting call, or the next one that waits, raise Interrupted."""
        self._interrupted = True

    def on_node(self, call: Callable[[], None]) -> None:
        """Call on the node's thread, and wait until the call has returned; no effect after the end of the node."""
        done: list[bool] = []

        def make() -> None:
            try:
                call()
            finally:
                done.append(True)

        self.node.post(make)
        self._wait(lambda: bool(done) or self._ended, _CALL_LIMIT)

    def until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait for a condition, and return whether it is true. Raises Lost when the node has ended, and Interrupted."""
        found = self._wait(lambda: self._ended or self._interrupted or condition(), seconds)
        if self._interrupted:
            self._interrupted = False
            raise Interrupted("the call was cancelled")
        if self._ended:
            raise Lost("the connection to the robot has ended")
        return found

    def settle(self, condition: Callable[[], bool], seconds: float) -> None:
        """Wait for a condition, also after the node has ended; never raises."""
        self._wait(lambda: self._ended or condition(), seconds)
