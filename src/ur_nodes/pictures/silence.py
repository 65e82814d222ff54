"""Reasons why a subscribed topic carries nothing: its publishers, and the last errors that they have logged."""

from collections.abc import Mapping, Sequence

from ur.source.printable import printable
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import LogLine

_ASK_EVERY = 2.0  # s
_LOG = "/rosout"


def explain_silence(publishers: Sequence[str], connections: int, errors: Mapping[str, str]) -> str:
    """Explain why nothing is received, in a clause.

    `publishers` are the nodes that publish the topic, `connections` how many of them are connected, `errors` the last
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
    """Explains why a topic carries nothing. Costs nothing before `explain` is called.

    Nodes latch their last log message, so an error from before the first call is found too.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node = node
        self._topic = topic
        self._publishers: tuple[str, ...] | None = None
        self._errors: dict[str, str] = {}
        self._log: Subscription | None = None
        self._asked_at = 0.0
        self._asking = False

    def explain(self, connections: int) -> str:
        """Return the reason as far as it is known by now; empty at first."""
        now = self._node.steady()
        if self._log is None:
            self._log = self._node.subscribe(_LOG, LogLine, self._on_line, Quality.LATCHED_EVERY)
            self._asked_at = now - _ASK_EVERY
        if not self._asking and now - self._asked_at >= _ASK_EVERY:
            self._asked_at, self._asking = now, True
            self._node.read_graph(self._on_graph)
        if self._publishers is None:
            return ""
        return explain_silence(self._publishers, connections, self._errors)

    def stop(self) -> None:
        """Forget everything: the topic carries messages again."""
        if self._log is not None:
            self._log.close()
            self._log, self._publishers, self._errors = None, None, {}

    def _on_line(self, line: LogLine) -> None:
        if line.level == "error":
            self._errors[line.node] = printable(line.text)

    def _on_graph(self, graph: Graph | None) -> None:
        self._asking = False
        if self._log is not None and graph is not None:
            topic = graph.topics.get(self._topic)
            self._publishers = topic.publishers if topic else ()
