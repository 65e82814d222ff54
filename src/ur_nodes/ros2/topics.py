"""Publishers and subscriptions of nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from rclpy.serialization import deserialize_message

from ur.source.diagnostic import UserError
from ur_nodes.codecs import KindCodec
from ur_nodes.codecs.bare import ORDERS, READERS, WRITERS, Reader
from ur_nodes.loop import Loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.topics import Sender
from ur_nodes.ports.validation import Refusals, usable
from ur_nodes.ros2 import ends
from ur_nodes.ros2.graph import Senders
from ur_nodes.ros2.names import resolve
from ur_nodes.ros2.qualities import offered, requested

if TYPE_CHECKING:
    import genpy
    from rclpy.node import Node

Value = TypeVar("Value")

_DEPTHS: dict[Quality, int | None] = {Quality.NEWEST: 1, Quality.FRESH: 1, Quality.LATCHED: 1, Quality.LOSSLESS: None}
_QUEUE = 100


class RosPublisher(Generic[Value]):
    """See `ports.node.Publisher`. One message is filled again for each value."""

    def __init__(
        self,
        node: Node,
        topic: str,
        kind: type,
        codec: KindCodec[Value],
        quality: Quality,
        on_subscriber: Callable[[], None] | None,
    ) -> None:
        self.topic = resolve(node, topic)
        self._fill, self._write = codec.fill, WRITERS.get(kind)
        self._message = codec.message_class()
        self._sender = ends.MessageSender(node, codec.message_class, self.topic, offered(quality, kind), on_subscriber)

    def send(self, value: Value) -> None:
        if self._write is None:
            self._fill(self._message, value)
        self._sender.send(self._message if self._write is None else self._write(value))

    def subscribers(self) -> int:
        return self._sender.subscribers()

    def close(self) -> None:
        self._sender.close()


class RosSubscription(Generic[Value]):
    """See `ports.node.Subscription`. Messages are decoded on the node's thread, so dropped ones are never decoded.

    `callback` gets values and None, or, with `senders`, the sender.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        kind: type,
        codec: KindCodec[Value],
        quality: Quality,
        loop: Loop,
        callback: Callable[[Value, Sender | None], None],
        unreadable: Callable[[str], None] | None,
        *,
        senders: bool = False,
    ) -> None:
        self.topic = resolve(node, topic)
        self._codec = codec
        self._read = READERS.get(kind)
        self._take = callback
        self._refusals = Refusals(self.topic, node.get_logger().error, unreadable)
        put = loop.mailbox(_DEPTHS.get(quality, _QUEUE), self._deliver)
        finder = Senders(node, self.topic)

        def put_from(message: genpy.Message | bytes, info: Mapping[str, Any]) -> None:
            put((message, finder.find(info)))

        self._receiver = ends.Receiver(
            node,
            codec.message_class,
            self.topic,
            requested(quality, kind),
            lambda message: put((message, None)),
            put_from if senders else None,
            raw=self._read is not None,
        )

    def publishers(self) -> int:
        return self._receiver.publishers()

    def close(self) -> None:
        self._receiver.close()

    def _deliver(self, item: tuple[genpy.Message | bytes, Sender | None]) -> None:
        message, sender = item
        try:
            value = usable(self._value_of(message))
        except (ValueError, UserError, RuntimeError) as problem:  # RuntimeError: rclpy's, for bytes of another kind
            self._refusals.report(str(problem), sender.name if sender else "")
            return
        self._take(value, sender)

    def _value_of(self, message: genpy.Message | bytes) -> Value:
        if isinstance(message, bytes):
            if self._read is not None and message[:2] in ORDERS:
                return cast("Value", self._read(Reader(message)))
            message = deserialize_message(message, self._codec.message_class)
        return self._codec.value_of(message)
