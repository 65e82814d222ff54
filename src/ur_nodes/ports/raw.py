"""Messages of any type, by the middleware's names of types: for tools that show any topic of a robot.

Nodes of our own exchange the values of `ports.values` instead.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, Protocol

from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.topics import Publisher, Sender, Subscription
from ur_nodes.ports.values import Result

Fields = Mapping[str, object]
"""The fields of a message by name: numbers, texts, lists, and mappings of such; a time has `secs` and `nsecs`."""


@dataclass(frozen=True, slots=True)
class RawMessage:
    """A message as its publisher sent it; `schema` is the definition of its type and of those that it holds."""

    type_name: str
    schema: str
    data: bytes
    sender: Sender | None = None


@dataclass(frozen=True, slots=True)
class ServiceAnswer:
    """The answer of a service, and the name of the service's type."""

    type_name: str
    fields: Fields


class ServiceCaller(Protocol):
    """The part of `Raw` that ROS 2 alone has: services of any type."""

    def call(self, service: str, fields: Fields, callback: Callable[[Result], None]) -> None:
        """Call a service without a timeout; `callback` gets a result with its ServiceAnswer, as lines in the text."""


@dataclass(frozen=True, slots=True)
class RecordedTopic:
    """A topic to record: the nodes that publish it, the time (s) between two messages, 0 for all, and its type."""

    name: str
    publishers: tuple[str, ...] = ()
    period: float = 0.0
    type_name: str = ""


@dataclass(frozen=True, slots=True)
class RecordedType:
    """The type of the messages of a topic; `schema` is as in RawMessage.

    `sender` is the node that publishes them, where the middleware knows it, and `latched` whether it keeps the newest.
    """

    topic: str
    type_name: str
    schema: str
    sender: str = ""
    latched: bool = False


class RecordedMessage(NamedTuple):
    """A message, and the time at which it arrived by the clock of its recorder."""

    type: RecordedType
    time: int
    data: bytes


class TopicRecorder(Protocol):
    """Records topics, as `Raw.record` made it."""

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        """Record these topics, and no others. Called about once a second: what has failed is then tried again."""

    def close(self) -> None:
        """Record nothing any more."""


class Raw(Protocol):
    """Sends and receives messages of any type. `encoding` is that of the bytes of messages: `ros1`, `cdr`, or ''."""

    encoding: str

    def find_schema(self, type_name: str) -> str | None:
        """Return the schema of a type; None if it is not installed. It may block: call it from `work`."""

    def subscribe(
        self, topic: str, callback: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        """Subscribe to a topic of any type."""

    def record(self, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]) -> TopicRecorder:
        """Record topics at little cost: `callback` gets messages in batches, with the times of `clock`, in ns."""

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> Publisher[Fields | bytes]:
        """Publish on a topic messages from fields, or from bytes. A header without a stamp gets the present time.

        Raises LookupError if the type is not installed. `send` raises ValueError for wrong fields.
        """


class RawSubscriber(Protocol):
    """The part of `Raw` that a recorder needs."""

    def subscribe(
        self, topic: str, callback: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        """See Raw."""


class SubscribedRecorder:
    """A TopicRecorder by subscriptions, for middleware that has no cheaper one; it receives what it leaves out, too."""

    def __init__(
        self, raw: RawSubscriber, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]
    ) -> None:
        self._raw, self._take, self._clock = raw, callback, clock
        self._open: dict[str, Subscription] = {}
        self._periods: dict[str, float] = {}
        self._last: dict[str, int] = {}
        self._types: dict[tuple[str, str], RecordedType] = {}

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        self._periods = {each.name: each.period for each in topics}
        for name in [name for name in self._open if name not in self._periods]:
            self._open.pop(name).close()
        for name in self._periods:
            if name not in self._open:
                self._open[name] = self._raw.subscribe(name, partial(self._receive, name), Quality.EVERY)

    def close(self) -> None:
        self.record(())

    def _receive(self, name: str, message: RawMessage) -> None:
        now = self._clock()
        period = self._periods.get(name, 0.0)
        if period > 0.0:
            if 0.0 <= (now - self._last.get(name, -(10**18))) * 1e-9 < period:
                return
            self._last[name] = now
        sender = message.sender.name if message.sender is not None else ""
        found = self._types.get((name, sender))
        if found is None or found.type_name != message.type_name or found.schema != message.schema:
            latched = message.sender is not None and message.sender.kept
            found = RecordedType(name, message.type_name, message.schema, sender, latched)
            self._types[name, sender] = found
        self._take((RecordedMessage(found, now, message.data),))


class RecordingRaw:
    """The part of `Raw` that records by subscriptions."""

    def record(
        self: RawSubscriber, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]
    ) -> TopicRecorder:
        return SubscribedRecorder(self, callback, clock)


UPSTREAM = {
    "move_base_simple/goal": "goal_pose",
    **{f"move_base/{end}": f"navigate_to_pose/{end}" for end in ("goal", "cancel", "state", "status", "feedback")},
    "move_base/NavfnROS/plan": "plan",
    "move_base/DWAPlannerROS/global_plan": "received_global_plan",
    "move_base/DWAPlannerROS/local_plan": "local_plan",
    "move_base/global_costmap/costmap": "global_costmap/costmap",
    "move_base/global_costmap/costmap_updates": "global_costmap/costmap_updates",
    "move_base/global_costmap/footprint": "global_costmap/published_footprint",
    "move_base/local_costmap/costmap": "local_costmap/costmap",
    "move_base/local_costmap/costmap_updates": "local_costmap/costmap_updates",
    "move_base/local_costmap/footprint": "local_costmap/published_footprint",
    "static_map": "map_server/map",
    "change_map": "map_server/load_map",
    "dynamic_map": "slam_toolbox/dynamic_map",
    "global_localization": "reinitialize_global_localization",
}
"""Ends of names of topics and services of ROS 1, and what Nav2 calls them: the table of `docs/reference/ros2.md`."""


def upstream_name(full: str) -> str:
    """Return the usual ROS 2 name of a topic or service; `full` is its name as on ROS 1, below any namespace."""
    for ours, theirs in UPSTREAM.items():
        done = theirs.endswith(f"/{ours}") and full.endswith(f"/{theirs}")
        if full.endswith(f"/{ours}") and not done:
            return full.removesuffix(ours) + theirs
    return full


def ros1_name(full: str) -> str:
    """Return the name on ROS 1 of a topic that `upstream_name` has named."""
    for ours, theirs in UPSTREAM.items():
        if full.endswith(f"/{theirs}"):
            return full.removesuffix(theirs) + ours
    return full
