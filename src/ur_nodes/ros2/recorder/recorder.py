"""Polls subscriptions of ROS 2 at intervals: a callback per message would dominate the processor time."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rclpy.impl.implementation_singleton import rclpy_implementation

from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic, RecordedType
from ur_nodes.ros2.reception import Unserved
from ur_nodes.ros2.recorder.arrivals import Arrivals
from ur_nodes.ros2.recorder.subscriptions import TopicPublishers, open_subscription, read_publishers

if TYPE_CHECKING:
    from rclpy.node import Node, Subscription


_PERIOD = 0.05  # s
_MOST_AT_ONCE = 200  # messages of a topic, while others wait
_OLDEST = 1_000_000_000  # ns that a message may have waited

_Publishers = tuple[tuple[str, ...], str, int]  # of a topic: their nodes, the type, and how many they are


@dataclass(slots=True)
class _OpenTopic:
    """A topic that is recorded: its publishers, its subscription, and the times of its messages."""

    publishers: _Publishers
    offer: TopicPublishers
    subscription: Subscription
    kind: RecordedType
    arrivals: Arrivals = field(default_factory=Arrivals)


class IntervalRecorder:
    """See `ports.raw.TopicRecorder`. A message has the time at which the middleware received it."""

    def __init__(
        self, node: Node, loop: Loop, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]
    ) -> None:
        self._node, self._take, self._clock = node, callback, clock
        self._group = Unserved()
        self._open: dict[str, _OpenTopic] = {}
        self._periods: dict[str, int] = {}
        self._beat = loop.every(_PERIOD, self._receive, steady=True)

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        self._periods = {each.name: int(each.period * 1e9) for each in topics}
        for name in [name for name in self._open if name not in self._periods]:
            self._node.destroy_subscription(self._open.pop(name).subscription)
        for each in topics:
            publishers = (each.publishers, each.type_name, self._node.count_publishers(each.name))
            opened = self._open.get(each.name)
            if opened is None or opened.publishers != publishers:
                self._subscribe(each.name, publishers)

    def _subscribe(self, topic: str, publishers: _Publishers) -> None:
        """Subscribe as the present publishers of a topic need it, which may be as before."""
        offer = read_publishers(self._node, topic)
        before = self._open.get(topic)
        if offer is None:
            return
        if before is not None:
            before.publishers = publishers
            if before.offer == offer:
                return
            self._receive()
            self._node.destroy_subscription(before.subscription)
        subscription, schema = open_subscription(self._node, topic, offer, Quality.EVERY, lambda _: None, self._group)
        self._open[topic] = _OpenTopic(publishers, offer, subscription, RecordedType(topic, offer.kind, schema))

    def close(self) -> None:
        self._receive()
        self.record(())
        self._beat.cancel()

    def _receive(self) -> None:
        batch: list[RecordedMessage] = []
        now, unix = self._clock(), time.time_ns()
        for name, each in self._open.items():
            handle, period = each.subscription.handle, self._periods[name]
            with suppress(rclpy_implementation.InvalidHandle), handle:
                for _ in range(_MOST_AT_ONCE):
                    taken = handle.take_message(each.subscription.msg_type, True)
                    if taken is None:
                        break
                    data, info = taken
                    waited = unix - (info["received_timestamp"] or unix)
                    moment = now - min(max(waited, 0), _OLDEST)
                    noted = each.arrivals.note(moment, period)
                    if noted is not None:
                        batch.append(RecordedMessage(each.kind, noted, bytes(data)))
        if batch:
            self._take(batch)
