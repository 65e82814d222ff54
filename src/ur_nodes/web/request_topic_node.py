"""Requests to another node on a topic, and the answers that come back with its state."""

from __future__ import annotations

import itertools
import json
import threading
from collections.abc import Callable, Mapping
from typing import Any

import rospy
from std_msgs.msg import String

from ur.source.printable import printable

Done = Callable[[str], None]
"""Called with what is wrong, or ''."""

_MOST_WAITING = 100


class RequestTopic:
    """Publishes requests as JSON with an `id`. Methods may be called from any thread."""

    def __init__(self, topic: str, name: str) -> None:
        """`name` begins the ids."""
        self._name = name
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._waiting: dict[str, Done] = {}
        self._requests = rospy.Publisher(topic, String, queue_size=10)

    def served(self) -> bool:
        """Tell whether a node takes requests."""
        return bool(self._requests.get_num_connections() > 0)

    def ask(self, request: Mapping[str, Any], done: Done) -> bool:
        """Send a request. Return False: no node takes it, and `done` is not called."""
        if not self.served():
            return False
        with self._lock:
            key = f"{self._name}-{next(self._numbers)}"
            self._waiting[key] = done
            while len(self._waiting) > _MOST_WAITING:
                del self._waiting[next(iter(self._waiting))]
        self._requests.publish(String(json.dumps({"id": key, **request})))
        return True

    def take(self, answer: tuple[str, str] | None) -> None:
        """Take the last answer of the node, id and problem; each one counts once."""
        with self._lock:
            done = self._waiting.pop(answer[0], None) if answer else None
        if done is not None and answer is not None:
            done(answer[1])


def read_answer(found: Any) -> tuple[str, str] | None:
    """The answer in a node's state. Raises TypeError or KeyError: it is malformed."""
    return None if found is None else (str(found["id"]), printable(str(found["problem"]))[:300])
