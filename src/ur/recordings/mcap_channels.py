"""MCAP files that are written, and topics as their channels: the encodings of ROS 1, of ROS 2, and of texts."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING, Literal

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


def start_writer(file: IO[bytes], profile: str, *, metadata: bool, chunk_bytes: int = 1 << 20) -> Writer:
    """Begin an MCAP file, with an index of metadata if it will have any: an empty index is an error in a file."""
    from mcap.writer import CompressionType, IndexType, Writer  # when something is written

    indexes = IndexType.CHUNK | IndexType.MESSAGE
    if metadata:
        indexes |= IndexType.METADATA
    writer = Writer(file, chunk_size=chunk_bytes, compression=CompressionType.ZSTD, index_types=indexes)
    writer.start(profile=profile, library="ubiquity_launches")
    return writer


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
