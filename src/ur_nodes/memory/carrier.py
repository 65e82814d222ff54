"""Time, ordered events, topics and services of a bus. The same calls give the same run to the last bit."""

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
from ur_nodes.ports.validation import problem_of
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
class BusSubscription:
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

    def deliver_oldest(self) -> None:
        """Deliver the oldest value that waits, if there is one."""
        if self.open and self.waiting:
            self.deliver(*self.waiting.pop(0))


@dataclass(eq=False, slots=True)
class BusPublisher:
    """A publisher of a node, with the value that it keeps."""

    sender: str
    kind: type | tuple[type, ...]
    latched: bool
    on_subscriber: Callable[[], None] | None
    type_name: str
    kept: object = None


@dataclass(eq=False, slots=True)
class BusTopic:
    """The publishers and subscriptions of a topic."""

    publishers: list[BusPublisher] = field(default_factory=list)
    subscribers: list[BusSubscription] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Service:
    """A service of a node: `handle` gets a request, and a function to call with the answer."""

    node: str
    kind: type
    handle: Callable[[object, Callable[[Result], None]], None]


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
        self._judged: tuple[object, str] = (None, "")

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
            self._run_next()
        self._time = end

    def run_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Let time pass until a condition is true after an event, at most `seconds`. Return whether it is."""
        end = self.now + round(seconds * 1e9)
        while not condition():
            if self._next_time() > end:
                self._time = end
                return condition()
            self._run_next()
        return True

    def problem_of(self, value: object) -> str:
        """Return what is wrong with a value; one that several nodes get one after the other is judged once."""
        if value is not self._judged[0]:
            self._judged = value, problem_of(value)
        return self._judged[1]

    def graph(self) -> Graph:
        """Return the graph of all topics and services."""
        topics = self.topics.items()
        return make_graph(
            {name: tuple(each.sender for each in topic.publishers) for name, topic in topics if topic.publishers},
            {name: tuple(each.node for each in topic.subscribers) for name, topic in topics if topic.subscribers},
            {name: topic.publishers[0].type_name for name, topic in topics if topic.publishers},
            {name: (service.node,) for name, service in self.services.items()},
            self.nodes,
        )

    def at(self, time: int, call: Callable[[], None]) -> None:
        """Call at a time (ns), after earlier calls for that time. For any thread."""
        if time <= self.now:
            self._due.append(call)
        else:
            heapq.heappush(self._events, (time, next(self._numbers), call))

    def add_publisher(self, topic: str, publisher: BusPublisher) -> None:
        """Add a publisher of a topic."""
        entry = self.topics.setdefault(topic, BusTopic())
        entry.publishers.append(publisher)
        if entry.subscribers and publisher.on_subscriber is not None:
            self.at(self.now, publisher.on_subscriber)

    def listen(
        self,
        node: str,
        topic: str,
        kind: type | tuple[type, ...],
        quality: Quality,
        deliver: Deliver,
        unreadable: Callable[[str], None],
    ) -> BusSubscription:
        """Add a subscription of a topic."""
        latched = None if kind is object else quality in _LATCHED
        subscription = BusSubscription(node, kind, latched, _DEPTHS.get(quality, DEPTH), deliver, unreadable)
        entry = self.topics.setdefault(topic, BusTopic())
        entry.subscribers.append(subscription)
        for publisher in entry.publishers:
            if publisher.on_subscriber is not None:
                self.at(self.now, publisher.on_subscriber)
            if publisher.latched and publisher.kept is not None and subscription.latched is not False:
                self._carry(topic, subscription, (publisher.kept, publisher.sender, True))
        return subscription

    def send(self, topic: str, publisher: BusPublisher, value: object) -> None:
        """Send a value of a publisher to all subscribers. Raises TypeError if it is of another kind."""
        if not isinstance(value, publisher.kind):
            expected = getattr(publisher.kind, "__name__", publisher.kind)
            raise TypeError(f"{topic}: {type(value).__name__} {value!r}, expected {expected}")
        if publisher.latched:
            publisher.kept = value
        for subscription in self.topics[topic].subscribers:
            if publisher.latched or not subscription.latched:
                self._carry(topic, subscription, (value, publisher.sender, False))

    def spoil(self, topic: str, reason: str) -> None:
        """Deliver an unreadable value, as from a faulty program."""
        for subscription in self.topics[topic].subscribers:
            self.at(self.now, partial(subscription.unreadable, reason))

    def _carry(self, topic: str, subscription: BusSubscription, item: tuple[object, str, bool]) -> None:
        if not isinstance(item[0], subscription.kind):
            return  # as with a master: types that differ are never connected
        delay = self._delay(topic)
        if delay is None:
            return

        if delay:
            self.at(self.now + delay, partial(self._arrive, subscription, item))
        else:
            self._arrive(subscription, item)

    def _arrive(self, subscription: BusSubscription, item: tuple[object, str, bool]) -> None:
        if subscription.open:
            subscription.waiting.append(item)
            del subscription.waiting[: -subscription.depth]
            self._due.append(subscription.deliver_oldest)

    def _next_time(self) -> float:
        if self._due:
            return self.now
        return self._events[0][0] if self._events else math.inf

    def _run_next(self) -> None:
        if self._due and (not self._events or self._events[0][0] > self.now):
            call = self._due.popleft()
        else:
            self._time, _, call = heapq.heappop(self._events)
        call()


def type_name_of(kind: type) -> str:
    """Return the name of a kind as a middleware's type: its `type_name`, or else its own name."""
    return str(getattr(kind, "type_name", kind.__name__))
