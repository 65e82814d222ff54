"""State of another node that pages show, and requests to change it, whose answers come back with the state."""

import itertools
from collections.abc import Callable, Mapping
from typing import Generic, TypeVar

from ur.source.foreign.json_values import read_json, write_json
from ur.source.printable import printable
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

Done = Callable[[str], None]
"""Called with the error, or ''."""

State = TypeVar("State")

_LONGEST = 2_000_000  # characters of a state
_MOST_WAITING = 100


class RequestTopic(Generic[State]):
    """Publishes requests as JSON with an `id` on the topic NAME_request; `state` is the newest on the topic NAMEs."""

    def __init__(self, node: Node, name: str, read: Callable[[Mapping[str, object]], State], first: State) -> None:
        """`read` converts JSON to a state; it raises ValueError, TypeError or KeyError if it is malformed."""
        self.state = first
        self._node, self._read = node, read
        self._numbers = itertools.count(1)
        self._waiting: dict[str, Done] = {}
        self._requests = node.publish(f"{name}_request", str, Quality.EVERY)
        self._states = node.subscribe(f"{name}s", str, self._take, Quality.LATCHED)

    def served(self) -> bool:
        """Return whether a node takes requests."""
        return self._requests.subscribers() > 0

    def ask(self, request: Mapping[str, object], done: Done) -> bool:
        """Send a request; return False without calling `done` if no node takes requests."""
        if not self.served():
            return False
        key = f"{self._node.name}-{next(self._numbers)}"
        self._waiting[key] = done
        while len(self._waiting) > _MOST_WAITING:
            del self._waiting[next(iter(self._waiting))]
        self._requests.send(write_json({"id": key, **request}))
        return True

    def _take(self, text: str) -> None:
        """Take a state, and the answer in it if that is new."""
        try:
            found = read_json(text, dict, _LONGEST)
            state, answer = self._read(found), found["answer"]
            id, problem = ("", "") if answer is None else (str(answer["id"]), printable(str(answer["problem"]))[:300])
        except (ValueError, TypeError, KeyError):
            self._node.log.warn(f"{self._states.topic}: not what a map server publishes; it is ignored", every=10.0)
            return
        self.state = state
        done = self._waiting.pop(id, None)
        if done is not None:
            done(problem)
