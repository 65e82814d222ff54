"""A recorder by subscriptions, for middleware that has no cheaper one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage, Recorded, RecordedTopic, RecordedType
from ur_nodes.ports.topics import Subscription


class RawSubscriber(Protocol):
    """The part of `Raw` that a recorder needs."""

    def subscribe(
        self, topic: str, take: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        """See Raw."""


class SubscribedRecorder:
    """See `ports.raw.Recorder`. What is not recorded of a topic is received all the same."""

    def __init__(
        self, raw: RawSubscriber, take: Callable[[Sequence[Recorded]], None], clock: Callable[[], int]
    ) -> None:
        self._raw, self._take, self._clock = raw, take, clock
        self._open: dict[str, Subscription] = {}
        self._periods: dict[str, float] = {}
        self._last: dict[str, int] = {}
        self._types: dict[str, RecordedType] = {}

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        """See Recorder."""
        self._periods = {each.name: each.period for each in topics}
        for name in [name for name in self._open if name not in self._periods]:
            self._open.pop(name).close()
        for name in self._periods:
            if name not in self._open:
                self._open[name] = self._raw.subscribe(name, partial(self._receive, name), Quality.EVERY)

    def close(self) -> None:
        """See Recorder."""
        self.record(())

    def _receive(self, name: str, message: RawMessage) -> None:
        now = self._clock()
        period = self._periods.get(name, 0.0)
        if period > 0.0:
            if 0.0 <= (now - self._last.get(name, -(10**18))) * 1e-9 < period:
                return
            self._last[name] = now
        found = self._types.get(name)
        if found is None or found.type_name != message.type_name or found.schema != message.schema:
            found = self._types[name] = RecordedType(name, message.type_name, message.schema)
        self._take((Recorded(found, now, message.data),))
