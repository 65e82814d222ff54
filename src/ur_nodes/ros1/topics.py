"""Publishers and subscriptions on ROS 1."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Generic, TypeVar

import genpy
import rospy

from ur.source.diagnostic import UserError
from ur_nodes.codecs import KindCodec, find_codec
from ur_nodes.codecs.dialect import time_of
from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.topics import Sender
from ur_nodes.ports.validation import Refusals, usable
from ur_nodes.ports.values import ClockTime
from ur_nodes.ros1.ending import quiet_at_end
from ur_nodes.ros1.repairs.own_clock import keep_own_clock

Value = TypeVar("Value")

_DEPTHS: dict[Quality, int | None] = {
    Quality.NEWEST: 1,
    Quality.LATCHED: 1,
    Quality.LATCHED_EVERY: 100,
    Quality.EVERY: 100,
    Quality.COMMAND: 100,
    Quality.FRESH: 1,
    Quality.LOSSLESS: None,  # rospy then sends at once, and waits until each connection has taken it
}


class RosPublisher(Generic[Value]):
    """See `ports.node.Publisher`. One message object is filled for each value, unless the topic is latched."""

    def __init__(self, topic: str, codec: KindCodec[Value], quality: Quality) -> None:
        self.topic = str(rospy.resolve_name(topic))
        self._codec = codec
        self._latched = quality is Quality.LATCHED
        self._message = codec.message_class()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)  # rospy takes LOSSLESS for a mistake
            self._publisher = rospy.Publisher(
                topic, codec.message_class, queue_size=_DEPTHS[quality], latch=self._latched, tcp_nodelay=True
            )

    @quiet_at_end
    def send(self, value: Value) -> None:
        message = self._codec.message_class() if self._latched else self._message
        self._codec.fill(message, value)
        self._publisher.publish(message)

    def subscribers(self) -> int:
        """See Publisher. Without locks, as it may be asked before each value."""
        implementation = self._publisher.impl
        return len(implementation.connections) if implementation is not None else 0

    def close(self) -> None:
        self._publisher.unregister()

    def watch(self, call: Callable[[], None]) -> None:
        """Call, on any thread, when a node subscribes."""
        self._publisher.impl.add_subscriber_listener(_Watcher(call))


class RosClock(RosPublisher[ClockTime]):
    """Publishes /clock, and sets this node's time to it at once."""

    def __init__(self, topic: str, quality: Quality) -> None:
        super().__init__(topic, find_codec(ClockTime), quality)
        self._set = keep_own_clock()

    def send(self, value: ClockTime) -> None:
        self._set(time_of(value.stamp))
        super().send(value)


class RosSubscription(Generic[Value]):
    """See `ports.node.Subscription`. Messages are decoded on the node's thread, so dropped ones are never decoded."""

    def __init__(
        self,
        topic: str,
        codec: KindCodec[Value],
        quality: Quality,
        loop: Loop,
        callback: Callable[[Value, genpy.Message], None],
        most: int | None = None,
        unreadable: Callable[[str], None] | None = None,
    ) -> None:
        """At most `most` messages wait, where they are large."""
        self.topic = str(rospy.resolve_name(topic))
        self._codec = codec
        self._take = callback
        self._refusals = Refusals(self.topic, rospy.logerr, unreadable)
        self._open = True
        depth = most if most is not None and quality is Quality.EVERY else _DEPTHS[quality]
        self._subscriber = rospy.Subscriber(
            topic,
            codec.message_class,
            loop.mailbox(depth, self._deliver),
            queue_size=depth,
            buff_size=codec.buffer,
            tcp_nodelay=True,
        )

    def publishers(self) -> int:
        return int(self._subscriber.get_num_connections())

    def close(self) -> None:
        self._open = False
        self._subscriber.unregister()

    def _deliver(self, message: genpy.Message) -> None:
        if not self._open:
            return
        try:
            value = usable(self._codec.value_of(unpack(message, self._codec.message_class)))
        except (ValueError, UserError) as problem:
            self._refusals.report(str(problem), str(header_of(message).get("callerid", ""))[:256])
            return
        self._take(value, message)


class _Watcher(rospy.SubscribeListener):
    """Calls a function for each new subscriber."""

    def __init__(self, call: Callable[[], None]) -> None:
        super().__init__()
        self._call = call

    def peer_subscribe(self, *_: object) -> None:
        """See rospy."""
        self._call()


def unpack(message: genpy.Message, message_class: type[genpy.Message]) -> genpy.Message:
    """Convert a message to a class: rospy decodes a topic by the class of its first subscription. Raises ValueError."""
    if not isinstance(message, rospy.AnyMsg) or message_class is rospy.AnyMsg:
        return message
    found = header_of(message).get("type")
    if found != message_class._type:  # noqa: SLF001 - genpy has no other name
        raise ValueError(f"a message of the type {found}, expected {message_class._type}")  # noqa: SLF001 - likewise
    try:
        return message_class().deserialize(message._buff)  # noqa: SLF001 - rospy has no other name
    except genpy.DeserializationError as problem:
        raise ValueError(str(problem)) from None


def header_of(message: genpy.Message) -> Mapping[str, str]:
    """Return the connection header of a message's publisher."""
    return getattr(message, "_connection_header", None) or {}


def sender_of(message: genpy.Message) -> Sender | None:
    """Return the sender of a message; None if unknown."""
    header = header_of(message)
    name = str(header.get("callerid", ""))[:256]
    return Sender(name, header.get("latching") == "1") if name else None
