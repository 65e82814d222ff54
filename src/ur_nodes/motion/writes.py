"""Writes and log lines of a node whose callbacks must not block on a disk, a terminal or a master."""

from collections.abc import Callable
from functools import partial

from ur_nodes.ports.node import Node

_LANE, _LOG_LANE = "writes", "log"


class Writes:
    """Makes writes on a worker, in order. The last one of each name is made even if the node ends meanwhile."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._open: dict[str, Callable[[], None]] = {}
        node.on_end(self._repeat)

    def write(self, name: str, job: Callable[[], None], callback: Callable[[str], None] = lambda _: None) -> None:
        """Make a write; `callback` gets the reason of a failure, empty on success."""
        self._open[name] = job

        def finish(problem: str) -> None:
            if self._open.get(name) is job:
                del self._open[name]
            callback(problem)

        self._node.work(partial(attempt, job), finish, _LANE)

    def _repeat(self) -> None:
        for job in self._open.values():
            self._node.work(partial(attempt, job), _ignore, _LANE)


class AsideLog:
    """See `ports.log.Log`: writes the lines of a node on a worker."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def debug(self, text: str) -> None:
        self._node.work(partial(self._node.log.debug, text), _ignore, _LOG_LANE)

    def info(self, text: str) -> None:
        self._node.work(partial(self._node.log.info, text), _ignore, _LOG_LANE)

    def warn(self, text: str, *, every: float = 0.0) -> None:
        self._node.work(partial(self._node.log.warn, text, every=every), _ignore, _LOG_LANE)

    def error(self, text: str, *, every: float = 0.0) -> None:
        self._node.work(partial(self._node.log.error, text, every=every), _ignore, _LOG_LANE)


def attempt(job: Callable[[], None]) -> str:
    """Make a call that may fail in the middleware, for example because the master ended.

    Returns the reason, empty on success.
    """
    try:
        job()
    except Exception as problem:
        return str(problem) or type(problem).__name__
    return ""


def _ignore(_done: object) -> None:
    """Do nothing."""
