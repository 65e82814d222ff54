"""Topics that are offered to viewers, and subscribed to while a viewer wants them. Bytes are never decoded."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from typing import Protocol

from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage

_PERIOD = 1.0  # s between two looks at the graph
_AT_ONCE, _PAUSE = 24, 0.1  # changes of offers at once, and s until the next: each is a message in a viewer's queue
_MOST_PUBLISHERS = 64


@dataclass(slots=True)
class Latched:
    """Messages by the name of their publisher, as bytes."""

    messages: dict[str, bytes] = field(default_factory=dict)

    def note(self, message: RawMessage) -> None:
        """Note a message."""
        if message.sender is not None and message.sender.kept:
            self.messages[message.sender.name] = message.data
            while len(self.messages) > _MOST_PUBLISHERS:
                del self.messages[next(iter(self.messages))]


def compare_topics(offered: Mapping[str, str], found: Iterable[tuple[str, str]]) -> tuple[list[str], dict[str, str]]:
    """Return the topics to withdraw, and the topics to offer with their types; a topic of a new type is in both."""
    now = {name: kind for name, kind in found if "/" in kind}
    ended = [name for name, kind in offered.items() if now.get(name) != kind]
    return ended, {name: kind for name, kind in now.items() if offered.get(name) != kind}


class Channel(Protocol):
    """A topic as viewers see it."""

    def log(self, data: bytes) -> None:
        """Send a message to the viewers that want it."""

    def close(self) -> None:
        """Withdraw the topic."""


OpenChannel = Callable[[str, str, str], Channel]
"""Offers a topic to viewers: its name, its type and the schema of the type."""


class AdvertisedTopics:
    """Offers all published topics. `report` takes lines for the user."""

    def __init__(self, node: Node, open_channel: OpenChannel, report: Callable[[str], object]) -> None:
        self._node, self._open_channel, self._report = node, open_channel, report
        self._offers: dict[str, _Offer] = {}
        self._unknown: set[str] = set()
        node.read_graph(self._compare)

    def change(self, topic: str, by: int) -> None:
        """Count a viewer that has subscribed (1) or unsubscribed (-1)."""
        if topic in self._offers:
            self._offers[topic].change(by)

    def _compare(self, graph: Graph | None) -> None:
        offered = {name: each.kind for name, each in self._offers.items()}
        ended, new = compare_topics(offered, graph.published() if graph is not None else offered.items())
        new = {name: kind for name, kind in new.items() if kind not in self._unknown}
        pause = _PAUSE if len(ended) + len(new) > _AT_ONCE else _PERIOD
        self._node.after(pause, lambda: self._node.read_graph(self._compare), steady=True)
        for name in ended[:_AT_ONCE]:
            self._offers.pop(name).end()
        if new := dict(islice(new.items(), _AT_ONCE - len(ended[:_AT_ONCE]))):
            self._node.work(partial(self._find_schemas, new), partial(self._offer, new), "schemas")

    def _find_schemas(self, topics: Mapping[str, str]) -> dict[str, str | None]:
        return {kind: self._node.raw.find_schema(kind) for kind in set(topics.values())}

    def _offer(self, topics: Mapping[str, str], schemas: Mapping[str, str | None]) -> None:
        for name, kind in topics.items():
            schema = schemas[kind]
            if name in self._offers:
                continue  # an earlier look has found it, too
            if schema is not None:
                self._offers[name] = _Offer(self._node, name, kind, self._open_channel(name, kind, schema))
            elif kind not in self._unknown:
                self._unknown.add(kind)
                self._report(f"{name}: not offered: {kind} is not installed on this computer")


class _Offer:
    """An offered topic, and the subscription to it while a viewer has subscribed."""

    def __init__(self, node: Node, name: str, kind: str, channel: Channel) -> None:
        self.kind = kind
        self._node, self._name, self._channel = node, name, channel
        self._wanted = 0
        self._subscription: Subscription | None = None
        self._latched = Latched()

    def change(self, by: int) -> None:
        self._wanted = max(0, self._wanted + by)
        if self._wanted and self._subscription is None:
            self._subscription = self._node.raw.subscribe(self._name, self._on_message, Quality.EVERY)
        elif self._wanted and by > 0:
            for data in self._latched.messages.values():
                self._channel.log(data)
        elif not self._wanted:
            self._unsubscribe()

    def end(self) -> None:
        """Withdraw the topic."""
        self._unsubscribe()
        self._channel.close()

    def _unsubscribe(self) -> None:
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None
            self._latched = Latched()

    def _on_message(self, message: RawMessage) -> None:
        self._latched.note(message)
        self._channel.log(message.data)
