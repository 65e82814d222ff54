"""Messages of ROS 2 in recordings, read as the values that a subscription gets of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from rclpy.serialization import deserialize_message

from ur_nodes.codecs import KindCodec, find_codec
from ur_nodes.codecs.frames import transforms_of
from ur_nodes.ports.raw import StoredReader
from ur_nodes.ros2.names import upstream_name

if TYPE_CHECKING:
    from ur_nodes.codecs.dialect import Transforms


def find_reader(topic: str, kind: type) -> StoredReader | None:
    """Find what a subscription of a kind reads; None: ROS 2 has no message for it."""
    try:
        codec: KindCodec[object] = find_codec(kind)
    except KeyError:
        return None
    message_class = codec.message_class
    bare = getattr(message_class, "BARE", None)
    package, name = bare[:2] if bare else (message_class.__module__.partition(".")[0], message_class.__name__)

    def read(data: bytes) -> object:
        try:
            message: object = message_class.read(data) if bare else deserialize_message(data, message_class)
        except RuntimeError as problem:  # of rclpy, for bytes of any program
            raise ValueError(str(problem)) from None
        return (
            transforms_of(cast("Transforms", message), fixed=True) if topic == "/tf_static" else codec.value_of(message)
        )

    return StoredReader(upstream_name(topic), f"{package}/msg/{name}", read)
