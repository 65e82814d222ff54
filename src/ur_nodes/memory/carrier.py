"""Time, ordered events, topics and services of a bus. The same calls give the same run to the last bit."""

from __future__ import annotations

import heapq
import itertools
import math
import sys
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

from ur_nodes.ports.graph import Graph, make_graph
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Result

DEPTH = 100
"""The number of values that may wait where each counts."""

_DEPTHS = {Quality.NEWEST: 1, Quality.FRESH: 1, Quality.LATCHED: 1, Quality.LOSSLESS: sys.maxsize}
_LATCHED = (Quality.LATCHED, Quality.LATCHED_EVERY)
Deliver = Callable[[object, str, bool], None]


class CarriedNode(Protocol):
    """A node of the bus, see `MemoryNode`."""

    lines: list[tuple[str, str]]
    ended: str | None

    def end(self, reason: str, *, failed: bool = False) -> None:
        """See Node."""


@dataclass(eq=False, slots=True)
class BusListener:
    """A subscription: `deliver` gets a value, the name of its sender, and whether it had been kept.

    It is `latched`, or not, or, None, as the publisher is. `unreadable` gets the reason why a value could not be read.
    """

    node: str
    kind: type | tuple[type, ...]
    latched: bool | None
    depth: int
    deliver: Deliver
    unreadable: Callable[[str], None]
    waiting: list[tuple[object, str, bool]] = field(default_factory=list)
    open: bool = True

    def take(self) -> None:
        """Deliver the oldest value that waits, if there is one."""
        if self.open and self.waiting:
            self.deliver(*self.waiting.pop(0))


@dataclass(eq=False, slots=True)
class Offer:
    """A publisher of a node, with the value that it keeps."""

    sender: str
    kind: type | tuple[type, ...]
    latched: bool
    greet: Callable[[], None] | None
    type_name: str
    kept: object = None


@dataclass(eq=False, slots=True)
class BusTopic:
    """The publishers and subscriptions of a topic."""

    offers: list[Offer] = field(default_factory=list)
    listeners: list[BusListener] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Service:
    """A service of a node: `take` gets a request, and a function to call with the answer."""

    node: str
    kind: type
    take: Callable[[object, Callable[[Result], None]], None]


class Carrier:
    """Carries values between the nodes of a bus and calls them, one callback at a time.

    `delay` gives for each topic how long (ns) the value that is sent now is on its way, None: it is lost. An exception
    of a callback leaves `run`.
    """

    def __init__(self, delay: Callable[[str], int | None] | None = None) -> None:
        self._time = 1_000_000_000
        self.facts: dict[str, Any] = {}
        self.parameters: dict[str, Any] = {}
        self.topics: dict[str, BusTopic] = {}
        self.services: dict[str, Service] = {}
        self.nodes: dict[str, CarriedNode] = {}
        self.types: dict[str, tuple[str, ...]] = {}  # fields of messages that are of no kind
        self.schemas: dict[str, str] = {}  # of messages that are raw
        self.durations: dict[str, float] = {}  # of jobs, s, by their lanes; others take no time
        self.hosts: dict[str, str] = {}  # of the nodes that run on other computers
        self._delay = delay or (lambda _topic: 0)
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._due: deque[Callable[[], None]] = deque()  # for the present, after what _events has for it
        self._numbers = itertools.count()

    @property
    def now(self) -> int:
        """Return the time, ns."""
        return self._time

    def load_parameters(self, namespace: str, values: dict[str, object]) -> None:
        """Set parameters below a full name, as `rosparam load` does with a file."""
        for name, value in values.items():
            if isinstance(value, dict):
                self.load_parameters(f"{namespace}/{name}", value)
            else:
                self.parameters[f"{namespace}/{name}"] = value

    def run(self, seconds: float) -> None:
        """Let time pass."""
        end = self.now + round(seconds * 1e9)
        while self._next_time() <= end:
            self._take_event()
        self._time = end

    def run_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Let time pass until a condition is true after an event, at most `seconds`. Return whether it is."""
        end = self.now + round(seconds * 1e9)
        while not condition():
            if self._next_time() > end:
                self._time = end
                return condition()
            self._take_event()
        return True

    def graph(self) -> Graph:
        """Return the graph of all topics and services."""
        topics = self.topics.items()
        return make_graph(
            {name: tuple(each.sender for each in topic.offers) for name, topic in topics if topic.offers},
            {name: tuple(each.node for each in topic.listeners) for name, topic in topics if topic.listeners},
            {name: topic.offers[0].type_name for name, topic in topics if topic.offers},
            {name: (service.node,) for name, service in self.services.items()},
            self.nodes,
        )

    def at(self, time: int, call: Callable[[], None]) -> None:
        """Call at a time (ns), after earlier calls for that time. For any thread."""
        if time <= self.now:
            self._due.append(call)
        else:
            heapq.heappush(self._events, (time, next(self._numbers), call))

    def offer(self, topic: str, offer: Offer) -> None:
        """Add a publisher of a topic."""
        entry = self.topics.setdefault(topic, BusTopic())
        entry.offers.append(offer)
        if entry.listeners and offer.greet is not None:
            self.at(self.now, offer.greet)

    def listen(
        self,
        node: str,
        topic: str,
        kind: type | tuple[type, ...],
        quality: Quality,
        deliver: Deliver,
        unreadable: Callable[[str], None],
    ) -> BusListener:
        """Add a subscription of a topic."""
        latched = None if kind is object else quality in _LATCHED
        listener = BusListener(node, kind, latched, _DEPTHS.get(quality, DEPTH), deliver, unreadable)
        entry = self.topics.setdefault(topic, BusTopic())
        entry.listeners.append(listener)
        for offer in entry.offers:
            if offer.greet is not None:
                self.at(self.now, offer.greet)
            if offer.latched and offer.kept is not None and listener.latched is not False:
                self._carry(topic, listener, (offer.kept, offer.sender, True))
        return listener

    def send(self, topic: str, offer: Offer, value: object) -> None:
        """Send a value of a publisher to all subscribers. Raises TypeError if it is of another kind."""
        if not isinstance(value, offer.kind):
            raise TypeError(
                f"{topic}: {type(value).__name__} {value!r}, expected {getattr(offer.kind, '__name__', offer.kind)}"
            )
        if offer.latched:
            offer.kept = value
        for listener in self.topics[topic].listeners:
            if offer.latched or not listener.latched:
                self._carry(topic, listener, (value, offer.sender, False))

    def spoil(self, topic: str, reason: str) -> None:
        """Deliver an unreadable value, as from a faulty program."""
        for listener in self.topics[topic].listeners:
            self.at(self.now, partial(listener.unreadable, reason))

    def _carry(self, topic: str, listener: BusListener, item: tuple[object, str, bool]) -> None:
        if not isinstance(item[0], listener.kind):
            return  # as with a master: types that differ are never connected
        delay = self._delay(topic)
        if delay is None:
            return

        if delay:
            self.at(self.now + delay, partial(self._arrive, listener, item))
        else:
            self._arrive(listener, item)

    def _arrive(self, listener: BusListener, item: tuple[object, str, bool]) -> None:
        if listener.open:
            listener.waiting.append(item)
            del listener.waiting[: -listener.depth]
            self._due.append(listener.take)

    def _next_time(self) -> float:
        if self._due:
            return self.now
        return self._events[0][0] if self._events else math.inf

    def _take_event(self) -> None:
        if self._due and (not self._events or self._events[0][0] > self.now):
            call = self._due.popleft()
        else:
            self._time, _, call = heapq.heappop(self._events)
        call()


def type_name_of(kind: type) -> str:
    """Return the name of a kind as a middleware's type: its `type_name`, or else its own name."""
    return str(getattr(kind, "type_name", kind.__name__))
