"""Topics as channels of MCAP files: the encodings of ROS 1, of ROS 2, and of texts without a type."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from mcap.writer import Writer

Dialect = Literal["ros1", "ros2", ""]

ENCODINGS: dict[Dialect, tuple[str, str]] = {"ros1": ("ros1msg", "ros1"), "ros2": ("ros2msg", "cdr"), "": ("", "text")}
"""The encodings of definitions and of messages."""


def dialect_of(type_name: str, schema: str) -> Dialect:
    """Return the ROS that a message type belongs to; "" for texts. It is also the profile of an MCAP file."""
    parts = type_name.split("/")
    if len(parts) == 3 and parts[1] == "msg":
        return "ros2"
    return "ros1" if len(parts) == 2 and schema else ""


SENDER, LATCHED = "callerid", "latching"
"""Metadata of a channel, as in rosbag files: the node that publishes it, and "1" if it keeps its newest message."""


def register_channel(
    writer: Writer, topic: str, type_name: str, schema: str, sender: str = "", *, latched: bool = False
) -> int:
    """Add a topic of a sender, with its type and the definition of the type, to an MCAP file.

    Returns the number of its channel.
    """
    schema_encoding, encoding = ENCODINGS[dialect_of(type_name, schema)]
    number = writer.register_schema(type_name, schema_encoding, schema.encode()) if schema_encoding else 0
    metadata = ({SENDER: sender} if sender else {}) | ({LATCHED: "1"} if latched else {})
    channel: int = writer.register_channel(topic, encoding, number, metadata)
    return channel
