"""Publishers and subscriptions on ROS 1."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Generic, TypeVar

import genpy
import rospy
from roslib.message import get_message_class

from ur.source.diagnostic import UserError
from ur_nodes.codecs import Codec, KindCodec, find_codec
from ur_nodes.codecs.dialect import time_of
from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields, RawMessage, RecordedMessage, TopicRecorder
from ur_nodes.ports.topics import Sender
from ur_nodes.ports.validation import Refusals, usable
from ur_nodes.ports.values import ClockTime
from ur_nodes.ros1.ending import quiet_at_end
from ur_nodes.ros1.repairs.own_clock import keep_own_clock

_BUFFER = 1 << 24  # bytes of one message
_MOST_WAITING = 20  # messages, each of which may be that large


class RosRaw:
    """See `ports.raw.Raw`."""

    encoding = "ros1"

    def __init__(self, loop: Loop) -> None:
        self._loop = loop

    def find_schema(self, type_name: str) -> str | None:
        found = _find_class(type_name)
        return None if found is None else str(found._full_text)  # noqa: SLF001 - genpy has no other name

    def subscribe(
        self, topic: str, callback: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> RosSubscription[RawMessage]:
        codec = Codec(rospy.AnyMsg, lambda _message, _value: None, _raw_of, _BUFFER)
        return RosSubscription(topic, codec, quality, self._loop, lambda value, _: callback(value), _MOST_WAITING)

    def record(self, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]) -> TopicRecorder:
        from ur_nodes.ros1.recorder.recorder import RosRecorder

        return RosRecorder(self._loop, str(rospy.get_name()), callback, clock)

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> RosPublisher[Fields | bytes]:
        found = _find_class(type_name)
        if found is None:
            raise LookupError(type_name)
        return RosPublisher(topic, Codec(found, _fill, lambda message: _raw_of(message).data), quality)


def _find_class(type_name: str) -> Any:
    """Import the class of a type; None if it is not installed or its import fails."""
    if not has_generated(type_name):
        return None
    try:
        return get_message_class(type_name)
    except Exception:  # a package of a workspace raises anything
        return None


def _raw_of(message: genpy.Message) -> RawMessage:
    """Return a message as it was sent; it has a class if another subscription of the topic was first."""
    header = header_of(message)
    if isinstance(message, rospy.AnyMsg):
        data = bytes(message._buff)  # noqa: SLF001 - rospy has no other name
    else:
        buffer = io.BytesIO()
        message.serialize(buffer)
        data = buffer.getvalue()
    return RawMessage(str(header.get("type", "")), str(header.get("message_definition", "")), data, sender_of(message))


def _make(found: type[genpy.Message], fields: Fields) -> genpy.Message:
    """Make a message from fields; a header's zero stamp becomes the present time. Raises ValueError."""
    message = found()
    try:
        genpy.message.fill_message_args(message, [dict(fields)] if fields else [])
        header: Any = getattr(message, "header", None)
        if isinstance(getattr(header, "stamp", None), genpy.Time) and header.stamp.is_zero():
            header.stamp = rospy.Time.now()
        message.serialize(io.BytesIO())
    except (genpy.MessageException, KeyError, TypeError, AttributeError) as problem:  # genpy calls methods of any value
        raise ValueError(str(problem)) from None
    return message


def _fill(message: genpy.Message, value: Fields | bytes) -> None:
    if isinstance(value, bytes):
        try:
            message.deserialize(value)
        except genpy.DeserializationError as problem:
            raise ValueError(str(problem)) from None
        return
    filled = _make(type(message), value)
    for name in message.__slots__:
        setattr(message, name, getattr(filled, name))


def has_generated(kind: str) -> bool:
    """Return whether PACKAGE/NAME has code that was generated for it.

    roslib imports any package that a type names, and a type comes from a page or from a node on the network.
    """
    package, _, name = kind.partition("/")
    if not package.isidentifier() or not name.isidentifier():
        return False
    try:
        found = find_spec(package)  # of a package without a dot nothing is imported
    except (ImportError, ValueError):
        return False
    folders = found.submodule_search_locations if found is not None else None
    return any(Path(folder, "msg", f"_{name}.py").is_file() for folder in folders or ())


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
        if self.subscribers():
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
