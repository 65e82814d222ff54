"""The patrol of the robot for user interfaces: its status, and requests with their answers."""

from collections import OrderedDict
from collections.abc import Callable

from ur_nodes.client.patrol_text import PatrolRequest, PatrolStatus, read_status, write_request
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

_MOST_WAITING = 20


class PatrolLink:
    """Shows the patrol and passes requests on. Reads may come from any thread."""

    def __init__(self, node: Node, patrol: str = "patrol") -> None:
        """`patrol` is the name of the node that drives the patrol."""
        self._node = node
        self._status = PatrolStatus()
        self._waiting: OrderedDict[str, Callable[[str], None]] = OrderedDict()
        self._requests = node.publish(f"{patrol}/request", str, Quality.EVERY)
        self._statuses = node.subscribe(f"{patrol}/status", str, self._take, Quality.LATCHED)

    def status(self) -> PatrolStatus | None:
        """Return the newest status; None without a patrol node."""
        return self._status if self._statuses.publishers() else None

    def served(self) -> bool:
        """Return whether a node takes requests."""
        return self._requests.subscribers() > 0

    def request(self, request: PatrolRequest, done: Callable[[str], None] | None = None) -> bool:
        """Publish a request; `done` is called with the refusal, or ''. Return False without a patrol node."""
        if not self.served():
            return False
        if done is not None:
            self._waiting[request.id] = done
            while len(self._waiting) > _MOST_WAITING:
                self._waiting.popitem(last=False)
        self._requests.send(write_request(request))
        return True

    def _take(self, text: str) -> None:
        status = read_status(text)
        if status is None:
            self._node.log.warn("the status of the patrol cannot be read and is not shown", every=10.0)
            return
        self._status = status
        done = self._waiting.pop(status.answer.id, None) if status.answer else None
        if done is not None and status.answer is not None:
            done(status.answer.problem)
