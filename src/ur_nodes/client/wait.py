"""Waiting of threads other than the node's."""

import time
from collections.abc import Callable

from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Result

Wait = Callable[[Callable[[], bool], float], bool]
"""Waits until a condition is true, at most so many seconds, and returns whether it is."""

_POLL = 0.01  # s
_HUNG_AFTER = 0.5  # s


def wait_in_real_time(condition: Callable[[], bool], seconds: float) -> bool:
    """See `Wait`, for a node with a thread of its own."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() >= end:
            return condition()
        time.sleep(_POLL)
    return True


class WatchedWait:
    """A `Wait` of a thread that other threads monitor."""

    def __init__(self, node: Node, wait: Wait) -> None:
        self._node, self._wait = node, wait
        self._seen_at = node.steady()
        self.on_look: Callable[[], None] = lambda: None
        """Called by the thread itself whenever it looks after its condition."""

    def __call__(self, condition: Callable[[], bool], seconds: float) -> bool:
        def look() -> bool:
            self._seen_at = self._node.steady()
            self.on_look()
            return condition()

        return self._wait(look, seconds)

    def hangs(self, after: float = _HUNG_AFTER) -> bool:
        """Return whether the thread has not checked its condition for `after` s. For any thread."""
        return self._node.steady() - self._seen_at > after


def call_and_wait(node: Node, wait: Wait, service: str, request: object, within: float = 5.0) -> Result:
    """Call a service and wait for the answer. Not for the node's thread."""
    answers: list[Result] = []
    node.post(lambda: node.call(service, request, answers.append, within))
    wait(lambda: bool(answers), within + 1.0)
    return answers[0] if answers else Result(False, f"no answer of {node.resolve(service)} within {within:g} s")
