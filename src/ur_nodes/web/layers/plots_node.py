"""Numbers of topics over time, for the plots that pages show: any numeric field of any topic, while a page plots it."""

from __future__ import annotations

import io
import math
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Any

import genpy
import rospy
from roslib.message import get_message_class

from ur.web.wire.frames import Kind, Layer, json_frame
from ur.web.wire.plots import PLOT, split_plot
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.layers.pacing import Every

_EVERY = 0.1  # s between two samples of all plots
_LOOK_EVERY = 3.0  # s between two looks for topics
_MOST_PLOTS = 24  # of all pages
_MOST_FIELDS = 1000  # of all topics that are offered
_DEEPEST = 5
_LONGEST = 1 << 20  # bytes of a message that is read
_NUMBERS = frozenset(
    f"{kind}{bits}" for kind, sizes in (("int", "8 16 32 64"), ("uint", "8 16 32 64"), ("float", "32 64"))
    for bits in sizes.split()
) | {"bool", "byte", "char"}  # fmt: skip

Topic = tuple[str, str]


def list_fields(kind: str, find_class: Callable[[str], Any] = get_message_class, deepest: int = _DEEPEST) -> list[str]:
    """The numeric fields of a message type, as paths with dots; none for a type that is not installed.

    Arrays and headers are left out.
    """
    return list(_walk(kind, "", find_class, deepest))


def _walk(kind: str, before: str, find_class: Callable[[str], Any], deepest: int) -> Iterator[str]:
    found = find_class(kind) if deepest > 0 and kind != "std_msgs/Header" else None
    if found is None:
        return
    for name, slot in zip(found.__slots__, found._slot_types, strict=True):  # noqa: SLF001 - genpy has no other name
        if slot in _NUMBERS:
            yield f"{before}{name}"
        elif "[" not in slot and "/" in slot:
            yield from _walk(slot, f"{before}{name}.", find_class, deepest - 1)


def read_number(message: Any, path: str) -> float | None:
    """The number at a path of a message; None where there is none, or it is not finite."""
    for name in path.split("."):
        if name not in getattr(message, "__slots__", ()):
            return None
        message = getattr(message, name)
    if not isinstance(message, (bool, int, float)):
        return None
    number = float(message)
    return float(f"{number:.6g}") if math.isfinite(number) else None


class PlotFeed:
    """Samples what pages plot, once for all of them. Messages are unpacked at most at the rate of samples.

    `subscribe` makes subscribers as rospy.Subscriber does; `list_topics` lists names and types of topics.
    """

    def __init__(
        self,
        send: Callable[[bytes], None],
        list_topics: Callable[[], Sequence[Topic]],
        subscribe: Callable[..., Any] = rospy.Subscriber,
    ) -> None:
        self._send, self._list_topics, self._subscriber = send, list_topics, subscribe
        self._lock = threading.Lock()
        self._open = False
        self._plots: frozenset[str] = frozenset()
        self._subscribers: dict[str, Any] = {}
        self._newest: dict[str, Any] = {}
        self._kinds: dict[str, list[str]] = {}
        self._offered: dict[str, list[str]] = {}
        self._send_every, self._look_every = Every(_EVERY), Every(_LOOK_EVERY)

    def want(self, plots: Collection[str], *, shown: bool) -> None:
        """Have these plots (`TOPIC:FIELD`) sampled; `shown`: a page chooses among all fields."""
        good = frozenset(sorted(plot for plot in plots if PLOT.fullmatch(plot))[:_MOST_PLOTS])
        if (shown and not self._open) or good - self._plots:
            self._look_every.hurry()
        self._open, self._plots = shown, good

    def step(self, now: float) -> None:
        """Subscribe to what is wanted, and send samples; to be called often, from one thread.

        `now` is time.monotonic().
        """
        if self._look_every.due(now):
            self._look()
        if not self._send_every.due(now):
            return
        with self._lock:
            newest, self._newest = self._newest, {}
        values = {}
        for plot in self._plots:
            topic, path = split_plot(plot)
            message = newest.get(topic)
            number = None if message is None else read_number(message(), path)
            if number is not None:
                values[plot] = number
        if values:
            self._send(json_frame(Kind.VALUES, {"t": round(now, 3), "v": values}, Layer.PLOTS))

    def _look(self) -> None:
        topics = {split_plot(plot)[0] for plot in self._plots}
        kinds = dict(self._list_topics()) if topics or self._open else {}
        for topic in self._subscribers.keys() - (topics & kinds.keys()):
            self._subscribers.pop(topic).unregister()
        for topic in (topics & kinds.keys()) - self._subscribers.keys():
            if get_message_class(kinds[topic]) is not None:
                self._subscribers[topic] = self._subscriber(
                    topic, rospy.AnyMsg, self._take, callback_args=(topic, kinds[topic]), queue_size=1
                )
        if self._open:
            self._offer(kinds)

    def _offer(self, kinds: dict[str, str]) -> None:
        """Send the fields that may be plotted, by topic, where they have changed."""
        offered, count = {}, 0
        for topic, kind in sorted(kinds.items()):
            if kind not in self._kinds:
                self._kinds[kind] = list_fields(kind)
            fields = [each for each in self._kinds[kind] if PLOT.fullmatch(f"{topic}:{each}")]
            count += len(fields)
            if count > _MOST_FIELDS:
                break
            if fields:
                offered[topic] = fields
        if offered != self._offered:
            self._offered = offered
            self._send(json_frame(Kind.FIELDS, {"fields": offered}, Layer.PLOTS))

    @quiet_at_end
    def _take(self, message: Any, topic: tuple[str, str]) -> None:
        name, kind = topic
        unpacked: list[Any] = []

        def unpack() -> Any:
            """The message, unpacked when it is first asked for; None where it is not one of this type."""
            if not unpacked:
                buffer = io.BytesIO()
                message.serialize(buffer)
                found = get_message_class(kind)
                try:
                    good = found is not None and buffer.tell() <= _LONGEST
                    unpacked.append(found().deserialize(buffer.getvalue()) if good else None)
                except genpy.DeserializationError:
                    unpacked.append(None)
            return unpacked[0]

        with self._lock:
            self._newest[name] = unpack
