"""The node that reports the graph to `ur` where there is no master to ask: graph_report_node SOCKET.

Each line of JSON that arrives is answered by one. {"topics": [NAME, ...]} wants these topics received; the answer has
`publishers`, `subscribers` and `services`, the nodes by name, `nodes`, and `received`: the times (monotonic, s) of the
messages since the last answer, by topic. With "frames" true it has `frames`, those of tf that are known.
"""

import os
import socket
import sys
import time
from collections.abc import Mapping
from functools import partial

from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.ports.topics import Subscription
from ur_nodes.web.server_link import Outlet, read_lines, run_for_server

_MOST_TIMES = 1000  # of a topic, in an answer
_NICENESS = 5  # it starts beside the nodes of a run, which it is not to hold up


class GraphReport:
    """Answers requests, one after the other."""

    def __init__(self, node: Node, connection: socket.socket) -> None:
        self._node = node
        self._outlet = Outlet(node, connection)
        self._topics: dict[str, Subscription] = {}
        self._times: dict[str, list[float]] = {}
        read_lines(node, {connection: self._on_request})

    def _on_request(self, request: Mapping[str, object]) -> None:
        topics = request.get("topics")
        wanted = set(map(str, topics)) if isinstance(topics, list) else set()
        for topic in self._topics.keys() - wanted:
            self._topics.pop(topic).close()
        for topic in wanted - self._topics.keys():
            self._topics[topic] = self._node.raw.subscribe(topic, partial(self._note, topic), Quality.EVERY)
        frames = sorted(self._node.transforms.frames()) if request.get("frames") else []
        self._node.read_graph(lambda graph: self._answer(graph, frames))

    def _note(self, topic: str, _message: RawMessage) -> None:
        times = self._times.setdefault(topic, [])
        if len(times) < _MOST_TIMES:
            times.append(time.monotonic())

    def _answer(self, graph: Graph | None, frames: list[str]) -> None:
        known = Graph() if graph is None else graph.without(self._node.name)
        received, self._times = self._times, {}
        self._outlet.send_line(
            {
                "publishers": {each.name: each.publishers for each in known.topics.values() if each.publishers},
                "subscribers": {each.name: each.subscribers for each in known.topics.values() if each.subscribers},
                "services": known.services,
                "nodes": known.nodes,
                "received": received,
                "frames": frames,
            }
        )


if __name__ == "__main__":
    os.nice(_NICENESS)
    sys.exit(run_for_server("ur_graph", GraphReport))
