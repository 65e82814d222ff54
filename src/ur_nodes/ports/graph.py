"""The graph of a run: nodes, topics and services."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic: its type ("" before the first publisher), its publishers and its subscribers."""

    name: str
    kind: str = ""
    publishers: tuple[str, ...] = ()
    subscribers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Graph:
    """Topics by name, the nodes that offer each service, and all nodes."""

    topics: dict[str, Topic] = field(default_factory=dict)
    services: dict[str, tuple[str, ...]] = field(default_factory=dict)
    nodes: tuple[str, ...] = ()

    def published(self) -> list[tuple[str, str]]:
        """Return name and type of each topic that has a publisher."""
        return [(each.name, each.kind) for each in self.topics.values() if each.publishers]

    def without(self, node: str) -> Graph:
        """Return the graph without a node."""

        def others(nodes: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(each for each in nodes if each != node)

        topics = {
            each.name: Topic(each.name, each.kind, others(each.publishers), others(each.subscribers))
            for each in self.topics.values()
        }
        services = {name: others(nodes) for name, nodes in self.services.items()}
        return Graph(
            {name: each for name, each in topics.items() if each.publishers or each.subscribers},
            {name: nodes for name, nodes in services.items() if nodes},
            others(self.nodes),
        )


Ends = dict[str, tuple[str, ...]]


def make_graph(
    publishers: Ends, subscribers: Ends, kinds: dict[str, str], services: Ends, nodes: Iterable[str] = ()
) -> Graph:
    """Make the graph from publishers, subscribers and servers in any order; `nodes` are nodes without any of these."""
    topics = {
        name: Topic(
            name,
            kinds.get(name, ""),
            tuple(sorted(set(publishers.get(name, ())))),
            tuple(sorted(set(subscribers.get(name, ())))),
        )
        for name in sorted({*publishers, *subscribers})
    }
    found = {each for ends in (publishers, subscribers, services) for names in ends.values() for each in names}
    return Graph(
        topics, {name: tuple(sorted(services[name])) for name in sorted(services)}, tuple(sorted({*found, *nodes}))
    )
