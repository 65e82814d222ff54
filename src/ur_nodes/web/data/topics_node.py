"""Topics as pages look at them: their rates while they are in view, and the messages of one that is printed."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import rospy

from ur.web.wire.data_frames import pack_json
from ur.web.wire.data_requests import Show
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.data.decode import BadMessageError, decode, render
from ur_nodes.web.data.definition import BadDefinitionError, read_definition
from ur_nodes.web.data.graph_node import RosGraph, Topic
from ur_nodes.web.data.rates import RateMeter
from ur_nodes.web.layers.pacing import Every

ECHO_EVERY = 0.1
"""Seconds between two messages that are printed."""

_LIST_EVERY = 1.0  # s
_MOST_TOPICS = 1000
_MOST_MEASURED = 40  # of all pages
_LONGEST = 1 << 20  # bytes of a message that is printed
_BUFFER = 1 << 24  # bytes of one message
_HEAVY = (
    "sensor_msgs/Image",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/PointCloud2",
    "theora_image_transport/Packet",
)
"""Types that are measured only while one is printed: to subscribe makes cameras work."""

Send = Callable[[bytes], None]


@dataclass(frozen=True, slots=True)
class _Message:
    kind: str
    definition: str
    data: bytes


class _Watched:
    """A topic that is subscribed to: its rate, and its newest message."""

    def __init__(self, topic: Topic, subscribe: Callable[..., Any]) -> None:
        self.topic, self.meter = topic, RateMeter(time.monotonic())
        self.lock = threading.Lock()
        self.newest: _Message | None = None
        self.count = 0
        self._subscriber = subscribe(topic.name, rospy.AnyMsg, self._take, queue_size=5, buff_size=_BUFFER)

    def end(self) -> None:
        """Unsubscribe."""
        self._subscriber.unregister()

    @quiet_at_end
    def _take(self, message: Any) -> None:
        header = message._connection_header  # noqa: SLF001 - rospy's own way to the type of AnyMsg
        data = bytes(message._buff)  # noqa: SLF001 - rospy's own way to the bytes of AnyMsg
        with self.lock:
            self.meter.note(time.monotonic(), len(data))
            self.count += 1
            self.newest = _Message(str(header.get("type", "")), str(header.get("message_definition", "")), data)


class TopicWatch:
    """Sends what pages show of topics. `subscribe` makes subscribers as rospy.Subscriber does."""

    def __init__(self, send: Send, subscribe: Callable[..., Any] = rospy.Subscriber) -> None:
        self._send, self._subscribe = send, subscribe
        self._watched: dict[str, _Watched] = {}
        self._printed: dict[int, tuple[str, int]] = {}
        self._list_every, self._echo_every = Every(_LIST_EVERY), Every(ECHO_EVERY)

    def hurry(self) -> None:
        """Have pages get what they show at once: one shows something else."""
        self._list_every.hurry()

    def step(self, now: float, shows: Mapping[int, Show], graph: RosGraph) -> None:
        """Subscribe to what pages show, and send it; to be called often, from one thread."""
        echoed = {each.echo for each in shows.values() if each.echo}
        if self._list_every.due(now):
            self._follow(self._choose(shows, graph, echoed))
            rows = self._list(now, graph) if any(each.topics is not None for each in shows.values()) else []
            for page, each in shows.items():
                if each.topics is not None:
                    self._send(pack_json(page, "topics", {"t": "topics", "rows": rows, "all": len(graph.topics)}))
        if echoed and self._echo_every.due(now):
            for page, each in shows.items():
                if each.echo:
                    self._print(page, each.echo)
        self._printed = {page: each for page, each in self._printed.items() if page in shows}

    def close(self) -> None:
        """Unsubscribe from all topics."""
        self._follow({})

    def _choose(self, shows: Mapping[int, Show], graph: RosGraph, echoed: set[str]) -> dict[str, Topic]:
        chosen = {name: graph.topics[name] for name in echoed & graph.topics.keys()}
        for name in sorted(name for each in shows.values() for name in each.topics or ()):
            topic = graph.topics.get(name)
            if len(chosen) < _MOST_MEASURED and topic is not None and topic.publishers and topic.kind not in _HEAVY:
                chosen[name] = topic
        return chosen

    def _follow(self, chosen: Mapping[str, Topic]) -> None:
        for name in [
            name for name, each in self._watched.items() if name not in chosen or each.topic.kind != chosen[name].kind
        ]:
            self._watched.pop(name).end()
        for name, topic in chosen.items():
            if name not in self._watched:
                self._watched[name] = _Watched(topic, self._subscribe)

    def _list(self, now: float, graph: RosGraph) -> list[list[Any]]:
        rows = []
        for name, topic in sorted(graph.topics.items())[:_MOST_TOPICS]:
            row: list[Any] = [name[:200], topic.kind[:200], len(topic.publishers), len(topic.subscribers)]
            watched = self._watched.get(name)
            if watched is not None:
                with watched.lock:
                    rate, bandwidth = watched.meter.measure(now)
                row += [round(rate, 1), round(bandwidth)]
            rows.append(row)
        return rows

    def _print(self, page: int, name: str) -> None:
        watched = self._watched.get(name)
        if watched is None:
            return
        with watched.lock:
            message, count = watched.newest, watched.count
        if message is None or self._printed.get(page) == (name, count):
            return
        self._printed[page] = name, count
        value = {"t": "echo", "topic": name, "kind": message.kind[:200], "size": len(message.data), "count": count}
        try:
            lines = print_message(message.kind, message.definition, message.data)
        except (BadDefinitionError, BadMessageError) as problem:
            value["problem"] = str(problem)[:300]
        else:
            value["lines"] = lines
        self._send(pack_json(page, "echo", value))


def print_message(kind: str, definition: str, data: bytes) -> list[str]:
    """The lines of a message. Raises BadDefinitionError and BadMessageError."""
    if len(data) > _LONGEST:
        raise BadMessageError(f"message of {len(data)} bytes, expected at most {_LONGEST} to print it")
    return render(decode(read_definition(kind, definition), data))
