"""Reasons why a subscribed topic carries nothing: its publishers by the master, their last errors by the log."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

import rosgraph
import rospy
from rosgraph_msgs.msg import Log

from ur.source.printable import printable

_ASK_EVERY = 2.0  # s


def explain_silence(publishers: Sequence[str], connections: int, errors: Mapping[str, str]) -> str:
    """Explain why nothing comes, in a clause.

    `publishers` are the nodes that the master names, `connections` how many of them are connected, `errors` the last
    error that each node has logged.
    """
    if not publishers:
        return "no node publishes it"
    for node in publishers:
        if errors.get(node):
            return f"{node}: {errors[node]}"
    names = " and ".join(publishers)
    if not connections:
        return f"{names} publishes it, but cannot be reached"
    return f"{names} publishes it, but sends nothing"


class SilenceMonitor:
    """Explains why a topic carries nothing. Costs nothing before it is asked; not for two threads at once.

    Nodes latch their last log message, so an error from before the first question is found too.
    """

    def __init__(self, topic: str) -> None:
        """`topic` is a resolved name."""
        self._topic = topic
        self._publishers: tuple[str, ...] | None = None
        self._errors: dict[str, str] = {}
        self._subscriber: Any = None
        self._over = threading.Event()

    def explain(self, connections: int) -> str:
        """Return the reason as far as it is known by now; empty at first."""
        if self._subscriber is None:
            self._over = threading.Event()
            self._subscriber = rospy.Subscriber("/rosout", Log, self._on_log, queue_size=100)
            threading.Thread(target=self._ask, args=(self._over,), name="silence", daemon=True).start()
        if self._publishers is None:
            return ""
        return explain_silence(self._publishers, connections, self._errors)

    def stop(self) -> None:
        """Forget everything: the topic carries messages again."""
        if self._subscriber is not None:
            self._over.set()
            self._subscriber.unregister()
            self._subscriber, self._publishers, self._errors = None, None, {}

    def _on_log(self, message: Any) -> None:
        if message.level >= Log.ERROR:
            self._errors[message.name] = printable(message.msg)

    def _ask(self, over: threading.Event) -> None:
        while not over.wait(_ASK_EVERY if self._publishers is not None else 0.0):
            try:
                published, _, _ = rosgraph.Master(rospy.get_name()).getSystemState()
            except (OSError, rosgraph.MasterException):
                over.wait(_ASK_EVERY)
                continue
            found = tuple(sorted(node for topic, nodes in published if topic == self._topic for node in nodes))
            if not over.is_set():
                self._publishers = found
