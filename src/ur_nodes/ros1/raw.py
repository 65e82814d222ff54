"""Messages of any type on ROS 1: genpy's classes by name, and rospy's AnyMsg."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

import genpy
import rospy
from roslib.message import get_message_class, get_service_class
from rosservice import get_service_type

from ur_nodes.codecs import Codec
from ur_nodes.loop import Loop, run_aside
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields, RawMessage, RecordedMessage, ServiceAnswer, ServiceType, TopicRecorder
from ur_nodes.ports.values import Result
from ur_nodes.ros1.topics import RosPublisher, RosSubscription, header_of, sender_of

_BUFFER = 1 << 24  # bytes of one message
_MOST_WAITING = 20  # messages, each of which may be that large


class RosRaw:
    """See `ports.raw.Raw`."""

    encoding = "ros1"

    def __init__(self, loop: Loop) -> None:
        self._loop = loop

    def find_schema(self, type_name: str) -> str | None:
        found = _find_class(type_name, "msg")
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
        found = _find_class(type_name, "msg")
        if found is None:
            raise LookupError(type_name)
        return RosPublisher(topic, Codec(found, _fill, lambda message: _raw_of(message).data), quality)

    def find_service(self, service: str, callback: Callable[[Result], None]) -> None:
        full = str(rospy.resolve_name(service))

        def find() -> None:
            try:
                kind, found = _find_service(full)
                result = Result(True, value=ServiceType(kind, str(found._request_class._full_text)))  # noqa: SLF001
            except Exception as problem:  # master and service are third-party programs with any answer
                result = Result(False, str(problem))
            self._loop.post(lambda: callback(result))

        run_aside(find)

    def call(self, service: str, fields: Fields, callback: Callable[[Result], None]) -> None:
        full = str(rospy.resolve_name(service))

        def ask() -> None:
            try:
                kind, found = _find_service(full)
                request = _make(found._request_class, fields)  # noqa: SLF001 - genpy has no other name
                answer = rospy.ServiceProxy(full, found)(request)
                result = Result(True, str(answer), ServiceAnswer(kind, _fields_of(answer)))
            except ValueError as problem:
                result = Result(False, f"value: {problem}")
            except Exception as problem:  # likewise
                result = Result(False, str(problem))
            self._loop.post(lambda: callback(result))

        run_aside(ask)


def _find_class(type_name: str, part: Literal["msg", "srv"]) -> Any:
    """Import the class of a type; None if it is not installed or its import fails."""
    if not has_generated(type_name, part):
        return None
    try:
        return get_message_class(type_name) if part == "msg" else get_service_class(type_name)
    except Exception:  # a package of a workspace raises anything
        return None


def _find_service(service: str) -> tuple[str, Any]:
    """Find the type of a service and its class. Raises LookupError, and the errors of rosservice."""
    kind = get_service_type(service)
    if kind is None:
        raise LookupError(f"{service}: no node offers it now")
    found = _find_class(str(kind), "srv")
    if found is None:
        raise LookupError(f"{service}: {kind} is not installed on this computer, expected its package")
    return str(kind), found


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


def _fields_of(value: object) -> Any:
    """Convert a message to fields; arrays of numbers stay arrays."""
    if isinstance(value, genpy.TVal):
        return {"secs": value.secs, "nsecs": value.nsecs}
    if isinstance(value, genpy.Message):
        return {name: _fields_of(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], (genpy.Message, genpy.TVal)):
        return [_fields_of(each) for each in value]
    return value


def has_generated(kind: str, part: Literal["msg", "srv"]) -> bool:
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
    return any(Path(folder, part, f"_{name}.py").is_file() for folder in folders or ())
