"""Work on a worker of which only the newest request counts."""

from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

from ur_nodes.ports.node import Node

Request = TypeVar("Request")
Outcome = TypeVar("Outcome")


class NewestWork(Generic[Request, Outcome]):
    """Runs one job at a time; of the waiting requests the newest is next."""

    def __init__(
        self, node: Node, queue: str, job: Callable[[Request], Outcome], callback: Callable[[Request, Outcome], None]
    ) -> None:
        """`job` runs on a worker, `callback` on the node's thread."""
        self._node, self._lane = node, queue
        self._job, self._take = job, callback
        self.busy = self._wanted = False
        self._waiting: Request | None = None

    def ask(self, request: Request) -> None:
        """Add a request; it replaces one that waits."""
        if self.busy:
            self._waiting = request
            return
        self.busy = self._wanted = True
        self._node.work(partial(self._job, request), partial(self._finish, request), self._lane)

    def drop(self) -> None:
        """Drop all earlier requests and their results."""
        self._wanted, self._waiting = False, None

    def _finish(self, request: Request, outcome: Outcome) -> None:
        self.busy, wanted = False, self._wanted
        if self._waiting is not None:
            waiting, self._waiting = self._waiting, None
            self.ask(waiting)
        if wanted:
            self._take(request, outcome)
