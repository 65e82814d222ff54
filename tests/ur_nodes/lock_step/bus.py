"""A bus on which a recording takes the place of all nodes but those under test. Time passes by its messages."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, TypeVar, cast

from tests.ur_nodes.lock_step.stored import StoredReader, find_reader

from ur.recordings.mcap_file import RecordingFile, StoredMessage
from ur.recordings.message_types import full_type_name
from ur.source.diagnostic import UserError
from ur_nodes.memory.carrier import BusPublisher, BusSubscription, Carrier, Deliver
from ur_nodes.memory.node import TRANSFORMS, MemoryNode
from ur_nodes.one_process.bus import LiveBus, LiveNode
from ur_nodes.ports.node import Location
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Transform

Value = TypeVar("Value")


class StepNode(LiveNode):
    """A node of the bus: its jobs run at once, and its time is that of the recording."""

    def work(self, job: Callable[[], Value], callback: Callable[[Value], None], queue: str = "") -> None:
        """See Node."""
        MemoryNode.work(self, job, callback, queue)

    def locate(self, name: str) -> Location | None:
        """See Node. The nodes that were recorded count as nodes of this computer."""
        return super().locate(name) or cast("StepBus", self._bus).locate_recorded(name)


class StepFacts:
    """See `ports.facts.Facts`. The clock of the run was the computer's."""

    simulated_time = False

    def __init__(self) -> None:
        self._values: dict[str, object] = {}

    def get(self, name: str, default: object = None) -> object:
        """See Facts."""
        return self._values.get(name, default)

    def set(self, name: str, value: object) -> None:
        """See Facts."""
        self._values[name] = value


class SentValue(NamedTuple):
    """A value that a node under test has sent, at a time in ns."""

    time: int
    topic: str
    value: object


@dataclass(frozen=True, slots=True)
class _Feed:
    """A kind of value that nodes receive on a topic, and how it is read."""

    topic: str
    kind: type
    reader: StoredReader


class StepBus(LiveBus):
    """See Bus. `tested` are the full names of the nodes that run: what they published in the recording is not sent.

    `latched` are topics that keep their newest message although the recording does not say so. `outputs` has what the
    nodes have sent, `recorded` what they had sent when it was recorded.
    """

    node_class: ClassVar[type[MemoryNode]] = StepNode

    def __init__(self, recording: RecordingFile, tested: frozenset[str], latched: frozenset[str]) -> None:
        super().__init__(StepFacts(), lambda *_: None)
        self._time = recording.start
        self._subscribed = {each.topic.name for each in recording.messages() if each.topic.sender in tested}
        self._tested, self._latched = tested, latched
        self._feeds: dict[str, dict[tuple[str, type], _Feed]] = {}
        self._offers: dict[tuple[str, type, str], BusPublisher] = {}
        self._kept: dict[tuple[str, str], StoredMessage] = {}
        self._senders: set[str] = set()
        self._frames: set[str] = set()  # whose transforms a node under test sends
        self._own: set[str] = set()  # recorded topics that nodes under test publish, where no sender is known
        self.outputs: list[SentValue] = []
        self.recorded: list[StoredMessage] = []

    @property
    def now(self) -> int:
        """Return the time, ns since the epoch."""
        return self._time

    def do(self, call: Callable[[], Value]) -> Value:
        """Call at once: while nodes start, nothing else happens."""
        return call()

    def advance(self, time: int) -> None:
        """Let time pass."""
        while self._next_time() <= time:
            self._run_next()
        self._time = max(self._time, time)

    def deliver(self, message: StoredMessage) -> None:
        """Send a message of the recording, unless a node under test had sent it."""
        topic = message.topic
        if topic.sender in self._tested or (not topic.sender and topic.name in self._own):
            self.recorded.append(message)
            return
        self._senders.add(topic.sender)
        if topic.latched or topic.name in self._latched:
            self._kept[topic.name, topic.sender] = message
        for feed in tuple(self._feeds.get(topic.name, {}).values()):
            self._pass(feed, message)

    def locate_recorded(self, name: str) -> Location | None:
        """Locate a node that was recorded."""
        return Location("localhost", here=True) if name in self._senders else None

    def add_publisher(self, topic: str, publisher: BusPublisher) -> None:
        """See Carrier. What a node under test had sent had a subscriber: the recorder at least."""
        super().add_publisher(topic, publisher)
        if publisher.sender not in self._tested:
            return
        reader = find_reader(topic, publisher.kind) if isinstance(publisher.kind, type) else None
        self._own |= {reader.topic if reader is not None else topic} - {TRANSFORMS}
        if topic in self._subscribed:
            nothing = BusSubscription("recording", publisher.kind, None, 1, lambda *_: None, lambda _reason: None)
            self.topics[topic].subscribers.append(nothing)

    def listen(
        self,
        node: str,
        topic: str,
        kind: type | tuple[type, ...],
        quality: Quality,
        deliver: Deliver,
        unreadable: Callable[[str], None],
    ) -> BusSubscription:
        """See Carrier."""
        own = kind[0] if isinstance(kind, tuple) else kind
        reader = find_reader(topic, own)
        if reader is not None and (topic, own) not in self._feeds.setdefault(reader.topic, {}):
            feed = self._feeds[reader.topic][topic, own] = _Feed(topic, own, reader)
            for (name, _), message in self._kept.items():
                if name == reader.topic:
                    self._pass(feed, message)
        return super().listen(node, topic, kind, quality, deliver, unreadable)

    def send(self, topic: str, offer: BusPublisher, value: object) -> None:
        """See Carrier."""
        if offer.sender in self._tested:
            self.outputs.append(SentValue(self._time, topic, value))
            if topic == TRANSFORMS:
                self._frames |= {each.child for each in cast("tuple[Transform, ...]", value)}
        super().send(topic, offer, value)

    def _pass(self, feed: _Feed, message: StoredMessage) -> None:
        topic = message.topic
        if full_type_name(topic.type_name) != full_type_name(feed.reader.type_name):
            return
        try:
            value = feed.reader.read(message.data)
        except (ValueError, UserError) as problem:
            self.spoil(feed.topic, str(problem))
            return
        if feed.topic == TRANSFORMS and not topic.sender:
            value = tuple(each for each in cast("tuple[Transform, ...]", value) if each.child not in self._frames)
        key = (feed.topic, feed.kind, topic.sender)
        offer = self._offers.get(key)
        if offer is None:
            latched = topic.latched or topic.name in self._latched
            offer = self._offers[key] = BusPublisher(topic.sender, feed.kind, latched, None, topic.type_name)
            self.add_publisher(feed.topic, offer)
        Carrier.send(self, feed.topic, offer, value)
