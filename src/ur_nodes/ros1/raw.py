"""Messages of any type on ROS 1: genpy's classes by name, and rospy's AnyMsg."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import genpy
import rospy
from roslib.message import get_message_class

from ur_nodes.codecs import Codec
from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields, RawMessage, RecordedMessage, TopicRecorder
from ur_nodes.ros1.topics import RosPublisher, RosSubscription, header_of, sender_of

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
