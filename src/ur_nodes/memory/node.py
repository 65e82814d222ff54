"""A node on a `Bus`."""

from collections.abc import Callable
from typing import TypeVar, cast

from ur_nodes.goal_topics import TopicGoalClient, TopicGoalServer
from ur_nodes.memory.carrier import BusPublisher, BusSubscription, Carrier, Deliver, Service, type_name_of
from ur_nodes.memory.raw import MemoryRaw
from ur_nodes.ports.actions import GoalFollower, GoalHandlers
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.log import Log
from ur_nodes.ports.node import Facts, Location, Sender
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.transforms import Transforms
from ur_nodes.ports.validation import Refusals, problem_of
from ur_nodes.ports.values import Result, Transform


class MemoryFacts:
    """See `ports.facts.Facts`: the bus's."""

    simulated_time = True

    def __init__(self, bus: Carrier) -> None:
        self._facts = bus.facts

    def get(self, name: str, default: object = None) -> object:
        return self._facts.get(name, default)

    def set(self, name: str, value: object) -> None:
        self._facts[name] = value


class MemoryParameters:
    """See `ports.parameters.ParameterStore`: those of the bus, by full names, as on a parameter server."""

    def __init__(self, resolve: Callable[[str], str], parameters: dict[str, object]) -> None:
        self._resolve, self._parameters = resolve, parameters

    def resolve(self, name: str) -> str:
        return self._resolve(name)

    def has(self, name: str) -> bool:
        full = self.resolve(name).rstrip("/")
        return full in self._parameters or any(each.startswith(full + "/") for each in self._parameters)

    def get(self, name: str) -> object:
        full = self.resolve(name).rstrip("/")
        if full in self._parameters:
            return self._parameters[full]
        below = {
            name[len(full) + 1 :]: value for name, value in self._parameters.items() if name.startswith(full + "/")
        }
        if not below:
            raise KeyError(full)
        tree: dict[str, object] = {}
        for path, value in below.items():
            *folders, last = path.split("/")
            place = tree
            for folder in folders:
                place = cast("dict[str, object]", place.setdefault(folder, {}))
            place[last] = value
        return tree

    def set(self, name: str, value: object) -> None:
        self._parameters[self.resolve(name).rstrip("/")] = value


class MemoryLog:
    """See `ports.log.Log`. Writes to `lines`: pairs of a level and a text."""

    def __init__(self, lines: list[tuple[str, str]], now: Callable[[], int]) -> None:
        self._lines, self._now = lines, now
        self._last: dict[str, int] = {}

    def debug(self, text: str) -> None:
        self._lines.append(("debug", text))

    def info(self, text: str) -> None:
        self._lines.append(("info", text))

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """See Log. With `every`, equal texts count as of one place."""
        self._write("warn", text, every)

    def error(self, text: str, *, every: float = 0.0) -> None:
        """As `warn`."""
        self._write("error", text, every)

    def _write(self, level: str, text: str, every: float) -> None:
        now = self._now()
        if every and now - self._last.get(text, -(10**18)) < every * 1e9:
            return
        self._last[text] = now
        self._lines.append((level, text))


class MemoryPublisher:
    """See `ports.node.Publisher`."""

    def __init__(self, bus: Carrier, topic: str, entry: BusPublisher) -> None:
        self.topic = topic
        self._bus, self._entry = bus, entry

    def send(self, value: object) -> None:
        if self._entry in self._bus.topics[self.topic].publishers:
            self._bus.send(self.topic, self._entry, value)

    def subscribers(self) -> int:
        return len(self._bus.topics[self.topic].subscribers)

    def close(self) -> None:
        self._entry.latched, self._entry.on_subscriber, self._entry.kept = False, None, None


class MemorySubscription:
    """See `ports.node.Subscription`."""

    def __init__(self, bus: Carrier, topic: str, subscription: BusSubscription, forget: Callable[[], None]) -> None:
        self.topic = topic
        self._bus, self._subscription, self._forget = bus, subscription, forget

    def publishers(self) -> int:
        return len(self._bus.topics[self.topic].publishers)

    def close(self) -> None:
        if self._subscription.open:
            self._subscription.open = False
            self._bus.topics[self.topic].subscribers.remove(self._subscription)
            self._forget()


class MemoryTimer:
    """See `ports.node.Timer`."""

    def __init__(self) -> None:
        self.on = True

    def cancel(self) -> None:
        self.on = False


Value = TypeVar("Value")

TRANSFORMS = "/tf"
FIXED_TRANSFORMS = "/tf_static"


class MemoryNode:
    """See `ports.node.Node`. `lines` are those of its log: pairs of a level and a text; `ended` says why it ended."""

    def __init__(self, bus: Carrier, name: str, remaps: dict[str, str]) -> None:
        self.name = "/" + name.lstrip("/")
        self.lines: list[tuple[str, str]] = []
        self.ended: str | None = None
        self.failed = False
        self.facts: Facts = MemoryFacts(bus)
        self.parameters = Parameters(MemoryParameters(self.resolve, bus.parameters))
        self.log: Log = MemoryLog(self.lines, self.now)
        self.raw = MemoryRaw(self, bus)
        self._bus = bus
        self._remaps = remaps
        self._transforms: Transforms | None = None
        self._listeners: list[tuple[str, BusSubscription]] = []
        self._publishers: list[tuple[str, BusPublisher]] = []
        self._services: list[str] = []
        self._at_end: list[Callable[[], None]] = []
        self._late: list[Callable[[], None]] | None = None  # calls that are still to be made at the end
        self._fixed: dict[str, Transform] = {}
        self._senders: dict[str, MemoryPublisher] = {}

    @property
    def transforms(self) -> Transforms:
        if self._transforms is None:
            self._transforms = tree = Transforms(self._send_transforms, self.log)
            self.subscribe(FIXED_TRANSFORMS, tuple, tree.receive, Quality.LATCHED_EVERY)
            self.subscribe(TRANSFORMS, tuple, tree.receive, Quality.EVERY)
        return self._transforms

    def publish(
        self,
        topic: str,
        kind: type[Value],
        quality: Quality = Quality.NEWEST,
        on_subscriber: Callable[[], Value | None] | None = None,
        type_name: str = "",
    ) -> MemoryPublisher:
        """See Node; `type_name` is the middleware's name of a type that is of no kind."""
        full = self.resolve(topic)

        def answer() -> None:
            value = on_subscriber() if on_subscriber is not None and self.ended is None else None
            if value is not None:
                publisher.send(value)

        entry = BusPublisher(
            self.name,
            _runtime(kind),
            quality is Quality.LATCHED,
            answer if on_subscriber else None,
            type_name or type_name_of(kind),
        )
        publisher = MemoryPublisher(self._bus, full, entry)
        self._publishers.append((full, entry))
        self._bus.add_publisher(full, entry)
        return publisher

    def subscribe(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value], None],
        quality: Quality = Quality.NEWEST,
        unreadable: Callable[[str], None] | None = None,
    ) -> MemorySubscription:
        return self._listen(topic, kind, lambda value, _sender, _kept: callback(value), quality, unreadable)

    def subscribe_from(
        self,
        topic: str,
        kind: type[Value],
        callback: Callable[[Value, Sender | None], None],
        quality: Quality = Quality.NEWEST,
    ) -> MemorySubscription:
        return self._listen(topic, kind, lambda value, sender, kept: callback(value, Sender(sender, kept)), quality)

    def subscribe_fields(
        self, topic: str, type_name: str, fields: tuple[str, ...], callback: Callable[[tuple[object, ...]], None]
    ) -> MemorySubscription:
        """See Node. The types are those of the bus's `types`, the messages dicts."""
        if type_name not in self._bus.types:
            raise LookupError(type_name)
        if not set(fields) <= set(self._bus.types[type_name]):
            raise ValueError(f"{type_name} has no {', '.join(fields)}")
        return self.subscribe(topic, dict, lambda value: callback(tuple(value[each] for each in fields)), Quality.EVERY)

    def serve(self, service: str, kind: type[Value], answer: Callable[[Value], Result]) -> None:
        self.serve_later(service, kind, lambda request, give: give(answer(request)))

    def serve_later(
        self, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        full = self.resolve(service)

        def check(request: object, give: Callable[[Result], None]) -> None:
            if not isinstance(request, kind):
                give(Result(False, f"{full}: a request {type(request).__name__}, expected {kind.__name__}"))
            elif problem := problem_of(request):
                give(Result(False, f"{full}: {problem}"))
            else:
                callback(request, give)

        self._services.append(full)
        self._bus.services[full] = Service(self.name, kind, check)

    def call(self, service: str, request: object, callback: Callable[[Result], None], within: float = 5.0) -> None:
        full, end = self.resolve(service), self._bus.now + round(within * 1e9)
        waiting = [callback]

        def give(result: Result) -> None:
            if waiting:
                waiting.pop()
                problem = problem_of(result)
                used = Result(False, f"{full}: {problem}") if problem else result
                self._bus.at(self._bus.now, lambda: callback(used) if self.ended is None else None)

        def ask() -> None:
            serve = self._bus.services.get(full)
            if serve is not None:
                serve.handle(request, give)
                self._bus.at(end, lambda: give(Result(False, f"no answer of {full} within {within:g} s")))
            elif self._bus.now < end:
                self._bus.at(min(self._bus.now + 100_000_000, end), ask)
            else:
                give(Result(False, f"no service {full} within {within:g} s"))

        self._bus.at(self._bus.now, ask)

    def serve_goals(self, action: str, handlers: GoalHandlers, kept: float = 5.0) -> TopicGoalServer:
        return TopicGoalServer(self, action, handlers, kept)

    def follow_goals(self, action: str, follower: GoalFollower) -> TopicGoalClient:
        return TopicGoalClient(self, action, follower)

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> MemoryTimer:  # noqa: ARG002
        """See Node. Both times are the bus's."""
        timer, period = MemoryTimer(), round(seconds * 1e9)

        def beat(due: int) -> None:
            if self.ended is None and timer.on:
                following = due + period
                if following + period < self._bus.now:  # late by more than one
                    following = self._bus.now
                self._bus.at(following, lambda: beat(following))
                call()

        self._bus.at(self._bus.now + period, lambda first=self._bus.now + period: beat(first))  # type: ignore[misc]
        return timer

    def after(self, seconds: float, call: Callable[[], None], *, steady: bool = False) -> MemoryTimer:  # noqa: ARG002
        timer = MemoryTimer()
        due = self._bus.now + round(seconds * 1e9)
        self._bus.at(due, lambda: call() if self.ended is None and timer.on else None)
        return timer

    def work(self, job: Callable[[], Value], callback: Callable[[Value], None], queue: str = "") -> None:
        """See Node. The job runs at once; its result comes with the next event, or after the lane's duration."""
        result = job()
        if self._late is None:
            self._bus.at(
                self._bus.now + round(self._bus.durations.get(queue, 0.0) * 1e9),
                lambda: callback(result) if self.ended is None else None,
            )
        else:
            self._late.append(lambda: callback(result))

    def post(self, call: Callable[[], None]) -> None:
        self._bus.at(self._bus.now, lambda: call() if self.ended is None else None)

    def now(self) -> int:
        return self._bus.now

    def steady(self) -> float:
        return self._bus.now * 1e-9

    def read_graph(self, callback: Callable[[Graph | None], None]) -> None:
        self.work(self._bus.graph, callback)

    def subscribed_kinds(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        entry = self._bus.topics.get(self.resolve(topic))
        subscribers = entry.subscribers if entry else []
        return frozenset(each.kind for each in subscribers if each.kind in kinds and each.node != self.name)

    def kinds_sent(self, topic: str, kinds: tuple[type, ...]) -> frozenset[type] | None:
        entry = self._bus.topics.get(self.resolve(topic))
        offers = entry.publishers if entry else []
        return frozenset(each.kind for each in offers if each.kind in kinds and each.sender != self.name)

    def locate(self, name: str) -> Location | None:
        """See Node. All nodes of the bus run here, but for those of its `hosts`."""
        if name in self._bus.hosts:
            return Location(self._bus.hosts[name], here=False)
        return Location("localhost", here=True) if name in self._bus.nodes else None

    def resolve(self, name: str) -> str:
        if name in self._remaps:
            name = self._remaps[name]
        if name.startswith("~"):
            full = f"{self.name}/{name[1:]}"
        else:
            full = name if name.startswith("/") else f"{self.name.rpartition('/')[0]}/{name}"
        return self._remaps.get(full, full)

    def hold_messages(self, hold: bool) -> None:
        """See Node: here messages do not wait."""

    def on_end(self, call: Callable[[], None], within: float = 2.0) -> None:  # noqa: ARG002
        self._at_end.append(call)

    def end(self, reason: str, *, failed: bool = False) -> None:
        if self._late is not None:
            return
        self._late = list(self._at_end)
        while self._late:
            self._late.pop(0)()
        self.ended, self.failed = reason, failed
        for topic, subscription in self._listeners:
            subscription.open = False
            self._bus.topics[topic].subscribers.remove(subscription)
        for topic, entry in self._publishers:
            self._bus.topics[topic].publishers.remove(entry)
        for service in self._services:
            self._bus.services.pop(service, None)
        if self._bus.nodes.get(self.name) is self:
            del self._bus.nodes[self.name]

    def _listen(
        self,
        topic: str,
        kind: type[Value],
        deliver: Callable[[Value, str, bool], None],
        quality: Quality,
        unreadable: Callable[[str], None] | None = None,
    ) -> MemorySubscription:
        full = self.resolve(topic)
        refusals = Refusals(full, self.log.error, unreadable)

        def on_request(value: Value, sender: str, kept: bool) -> None:
            if kind is not object and (problem := self._bus.problem_of(value)):  # raw ones are recorded as they are
                refusals.report(problem, sender)
            else:
                deliver(value, sender, kept)

        subscription = self._bus.listen(
            self.name, full, _runtime(kind), quality, cast("Deliver", on_request), refusals.report
        )
        self._listeners.append((full, subscription))
        return MemorySubscription(self._bus, full, subscription, lambda: self._listeners.remove((full, subscription)))

    def _send_transforms(self, transforms: tuple[Transform, ...]) -> None:
        fixed = [each for each in transforms if each.fixed]
        moving = tuple(each for each in transforms if not each.fixed)
        if fixed:
            self._fixed.update({each.child: each for each in fixed})
            self._sender(FIXED_TRANSFORMS, Quality.LATCHED).send(tuple(self._fixed.values()))
        if moving:
            self._sender(TRANSFORMS, Quality.EVERY).send(moving)

    def _sender(self, topic: str, quality: Quality) -> MemoryPublisher:
        if topic not in self._senders:
            self._senders[topic] = self.publish(topic, tuple, quality)
        return self._senders[topic]


def _runtime(kind: type) -> type | tuple[type, ...]:
    return (float, int) if kind is float else kind
