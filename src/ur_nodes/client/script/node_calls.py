"""Calls from a program's thread on the thread of its node, and waiting for their results."""

from collections.abc import Callable

from ur_nodes.client.script.errors import Interrupted, Lost
from ur_nodes.client.wait import WatchedWait
from ur_nodes.ports.node import Node

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
