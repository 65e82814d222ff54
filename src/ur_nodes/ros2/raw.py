"""Messages of any type on ROS 2: CDR bytes, and rclpy's classes by name.

A type that is not installed is received all the same: its publisher gives its name and hash, see `bare_type`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.node import Node, Subscription
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message

from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields, RawMessage, RecordedMessage, ServiceAnswer
from ur_nodes.ports.values import Result
from ur_nodes.ros2 import ends
from ur_nodes.ros2.messages.packages import find_bare, find_class, find_schema
from ur_nodes.ros2.names import name_of, resolve
from ur_nodes.ros2.qualities import offered
from ur_nodes.ros2.recorder.recorder import IntervalRecorder
from ur_nodes.ros2.recorder.subscriptions import open_subscription, read_publishers

if TYPE_CHECKING:
    import genpy

_READY = 0.02  # s between two looks for the other end of a client
_FIND = 2.0  # s that it may take
_LOOK = 0.2  # s between two looks for a publisher
_MOST_WAITING = 20  # messages, each of which may be large


class RosRaw:
    """See `ports.raw.Raw`."""

    encoding = "cdr"

    def __init__(self, node: Node, loop: Loop) -> None:
        self._node, self._loop = node, loop

    def find_schema(self, type_name: str) -> str | None:
        return find_schema(type_name)

    def subscribe(
        self, topic: str, callback: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> RawSubscription:
        return RawSubscription(self._node, self._loop, topic, callback, quality)

    def record(
        self, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]
    ) -> IntervalRecorder:
        return IntervalRecorder(self._node, self._loop, callback, clock)

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> RawPublisher:
        found = find_class(type_name) or find_bare(type_name)
        if found is None:
            raise LookupError(type_name)
        return RawPublisher(self._node, topic, found, offered(quality))

    def call(self, service: str, fields: Fields, callback: Callable[[Result], None]) -> None:
        """See `ports.raw.ServiceCaller`."""
        full = str(self._node.resolve_service_name(name_of(service)))
        kind = next((types[0] for name, types in self._node.get_service_names_and_types() if name == full), None)
        if kind is None:
            callback(Result(False, f"{full}: no node offers it now"))
            return
        found: Any = find_class(kind, "srv")
        if found is None:
            callback(Result(False, f"{full}: {kind} is not installed on this computer, expected its package"))
            return
        try:
            request = make_message(found.Request, fields, self._node)
        except ValueError as problem:
            callback(Result(False, f"value: {problem}"))
            return
        client = self._node.create_client(found, name_of(service))

        def answer(future: rclpy.Future) -> None:
            answered = fields_of(future.result())
            self._loop.post(lambda: callback(Result(True, str(answered), ServiceAnswer(kind, answered))))
            self._loop.post(lambda: self._node.destroy_client(client))

        def send(left: float) -> None:
            if left <= 0.0 or client.service_is_ready():  # before, the server drops the answer
                client.call_async(request).add_done_callback(answer)
            else:
                self._loop.after(_READY, lambda: send(left - _READY), steady=True)

        send(_FIND)


class RawPublisher:
    """See `ports.node.Publisher`."""

    def __init__(self, node: Node, topic: str, message_class: type[genpy.Message], profile: QoSProfile) -> None:
        self.topic = resolve(node, topic)  # a recording may have ROS 1's name
        self._node, self._class = node, message_class
        self._sender = ends.MessageSender(node, message_class, self.topic, profile)

    def send(self, value: Fields | bytes) -> None:
        self._sender.send(value if isinstance(value, bytes) else make_message(self._class, value, self._node))

    def subscribers(self) -> int:
        return self._sender.subscribers()

    def close(self) -> None:
        self._sender.close()


class RawSubscription:
    """See `ports.node.Subscription`. It begins with the first publisher, which gives the type."""

    def __init__(
        self, node: Node, loop: Loop, topic: str, callback: Callable[[RawMessage], None], quality: Quality
    ) -> None:
        self.topic = str(node.resolve_topic_name(name_of(topic)))
        self._node, self._loop, self._take, self._quality = node, loop, callback, quality
        self._put = loop.mailbox(1 if quality is Quality.NEWEST else _MOST_WAITING, self._pass_on)
        self._subscription: Subscription | None = None
        self._kind = self._schema = ""
        self._open = True
        self._look()

    def publishers(self) -> int:
        return int(self._node.count_publishers(self.topic))

    def close(self) -> None:
        self._open = False
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)

    def _look(self) -> None:
        if not self._open:
            return
        offer = read_publishers(self._node, self.topic)
        if offer is None:
            self._loop.after(_LOOK, self._look, steady=True)
        else:
            opened = open_subscription(self._node, self.topic, offer, self._quality, self._put)
            self._kind, (self._subscription, self._schema) = offer.kind, opened

    def _pass_on(self, data: bytes) -> None:
        if self._open:
            self._take(RawMessage(self._kind, self._schema, bytes(data)))


def make_message(message_class: type[genpy.Message], fields: Fields, node: Node) -> genpy.Message:
    """Make a message with fields; a header's stamp is now unless given. Raises ValueError."""
    message = message_class()
    _fill(message, fields, "")
    header: Any = getattr(message, "header", None)
    if hasattr(header, "stamp") and header.stamp.sec == header.stamp.nanosec == 0:
        header.stamp = node.get_clock().now().to_msg()
    try:
        serialize_message(message)
    except (AssertionError, TypeError, SystemError, OverflowError) as problem:
        known = ", ".join(f"{name}: {kind}" for name, kind in message.get_fields_and_field_types().items())
        raise ValueError(f"{problem}, expected {known}") from None
    return message


def fields_of(value: Any) -> Any:
    """Convert a message to fields; arrays of numbers are kept."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: fields_of(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, list) and value and hasattr(value[0], "get_fields_and_field_types"):
        return [fields_of(each) for each in value]
    return value


def _fill(message: genpy.Message, fields: Fields, path: str) -> None:
    known = message.get_fields_and_field_types()
    for name, value in fields.items():
        own = {"secs": "sec", "nsecs": "nanosec"}.get(name, name)
        if own not in known:
            raise ValueError(f"{path}{name}: no such field, expected one of {', '.join(known)}")
        now = getattr(message, own)
        if isinstance(value, Mapping):
            if not hasattr(now, "get_fields_and_field_types"):
                raise ValueError(f"{path}{name}: a mapping, expected {known[own]}")
            _fill(now, value, f"{path}{name}.")
        elif isinstance(value, list) and "/" in known[own]:
            setattr(message, own, [_part(known[own], each, f"{path}{name}.") for each in value])
        else:
            try:
                if known[own] == "octet" and isinstance(value, int):
                    value = bytes([value])
                setattr(message, own, float(value) if isinstance(now, float) and type(value) is int else value)
            except (AssertionError, TypeError, OverflowError) as problem:
                raise ValueError(f"{path}{name}: {problem}") from None


def _part(kind: str, fields: object, path: str) -> genpy.Message:
    found = find_class(kind.removeprefix("sequence<").partition(">")[0].partition("[")[0].partition(",")[0])
    if found is None or not isinstance(fields, Mapping):
        raise ValueError(f"{path}: expected fields of {kind}")
    message: genpy.Message = found()
    _fill(message, fields, path)
    return message
