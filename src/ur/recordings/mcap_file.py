"""Recordings: MCAP files, of the black box and of other recorders. What they hold is checked while it is read.

The file is read piece by piece: a recording may be larger than the memory.
"""

from __future__ import annotations

import math
import os
import shlex
import struct
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from io import BytesIO
from itertools import islice
from operator import itemgetter
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ur.recordings.mcap_channels import LATCHED, SENDER
from ur.source.diagnostic import UserError, user_error_about
from ur.source.foreign.files import open_file, refuse_file
from ur.source.printable import printable

if TYPE_CHECKING:
    from mcap.records import Channel, Chunk, McapRecord, Message, Schema
    from mcap.summary import Summary

MOST_RECORD = 64 * 1024 * 1024  # bytes, also of an unpacked chunk
_MOST_UNPACKED, _MOST_RATIO = 256 * 1024 * 1024, 200  # bytes that a file may unpack to, plus so many times its size
_RECORD = struct.Struct("<BQ")  # kind and length
_SCHEMA, _CHANNEL, _MESSAGE = 3, 4, 5
_MOST_SUMMARY = 64 * 1024 * 1024
_MOST_METADATA = 1000
_TAIL = 37  # bytes of the last record and the magic
PER_RECORD = 300  # bytes of memory besides its data


def read_records(
    file: IO[bytes], complete: bool, begin: int, topics: Set[str] | None, channels: dict[int, Channel]
) -> Iterator[tuple[float, McapRecord | None]]:
    """Yield the records of a file, each with the time that no later message is older than."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader

    left = _MOST_UNPACKED + _MOST_RATIO * os.fstat(file.fileno()).st_size
    summary = read_summary(file)[0] if complete else None
    indexes = summary.chunk_indexes if summary is not None else []
    if summary is not None:
        yield from ((0.0, each) for each in (*summary.schemas.values(), *summary.channels.values()))
    wanted = {number for number, each in channels.items() if topics is None or each.topic in topics}
    starts: Iterable[tuple[float, int]] = sorted(
        (each.message_start_time, each.chunk_start_offset)
        for each in indexes
        if each.message_end_time >= begin
        and not (each.message_index_offsets and wanted.isdisjoint(each.message_index_offsets))
    )
    for start, offset in starts if indexes else [(0.0 if complete else math.inf, 0)]:
        file.seek(offset)
        stream = StreamReader(file, skip_magic=offset > 0, emit_chunks=True, record_size_limit=MOST_RECORD)
        for record in islice(stream.records, 1 if indexes else None):
            yield start, None
            if not isinstance(record, Chunk):
                yield start, record
                continue
            data = _unpack(record)
            left -= len(data)
            for inner in _split_chunk(data):
                left -= PER_RECORD
                yield start, inner
                if left < 0:
                    raise ValueError("it unpacks to too much")


def _split_chunk(data: bytes) -> Iterator[McapRecord | None]:
    """Yield the records of a chunk, None for one of another kind."""
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Message, Schema

    place = 0
    while place < len(data):
        opcode, length = _RECORD.unpack_from(data, place)
        place += _RECORD.size + length
        stream = ReadDataStream(BytesIO(data[place - length : place]))
        if opcode == _MESSAGE:
            yield Message.read(stream, length)
        elif opcode in (_SCHEMA, _CHANNEL):
            yield (Schema if opcode == _SCHEMA else Channel).read(stream)
        else:
            yield None


def _unpack(chunk: Chunk) -> bytes:
    """Return the content of a chunk, of the size that it declares. Raises ValueError, and errors of decompressors."""
    size = chunk.uncompressed_size
    if size > MOST_RECORD:
        raise ValueError(f"a chunk of {size:,} bytes, expected at most {MOST_RECORD:,}")
    if chunk.compression == "zstd":
        from zstandard import ZstdDecompressor

        data = ZstdDecompressor(max_window_size=MOST_RECORD).stream_reader(chunk.data).read(size + 1)
    elif chunk.compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

        data = LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
    else:
        data = chunk.data
    if len(data) != size:
        raise ValueError(f"a chunk that does not have the {size:,} bytes that it declares")
    return data


def read_summary(file: IO[bytes]) -> tuple[Summary | None, dict[str, dict[str, str]]]:
    """Return what the end of a file says of it, None where it says nothing, and its metadata; no chunk is unpacked.

    Raises ValueError, and errors of the library.
    """
    from mcap.records import Channel, ChunkIndex, Footer, Metadata, MetadataIndex, Schema, Statistics
    from mcap.stream_reader import StreamReader
    from mcap.summary import Summary

    def records(place: int) -> Iterator[McapRecord]:
        file.seek(place)
        return StreamReader(file, skip_magic=True, emit_chunks=True, record_size_limit=MOST_RECORD).records

    size = file.seek(-_TAIL, os.SEEK_END) + _TAIL
    footer = next(records(size - _TAIL))
    if not isinstance(footer, Footer):
        raise ValueError("its end is missing")
    if not footer.summary_start:
        return None, {}
    if size - footer.summary_start > _MOST_SUMMARY:
        raise ValueError("its index is too large")
    summary = Summary()
    for record in records(footer.summary_start):
        if isinstance(record, Statistics):
            summary.statistics = record
        elif isinstance(record, Schema):
            summary.schemas[record.id] = record
        elif isinstance(record, Channel):
            summary.channels[record.id] = record
        elif isinstance(record, ChunkIndex):
            summary.chunk_indexes.append(record)
        elif isinstance(record, MetadataIndex):
            summary.metadata_indexes.append(record)
    first = (next(records(each.offset)) for each in summary.metadata_indexes[:_MOST_METADATA])
    return summary, {each.name: dict(each.metadata) for each in first if isinstance(each, Metadata)}


MAGIC = b"\x89MCAP"
_RARE_HZ = 0.2
_MOST_HELD = 512 * 1024 * 1024  # bytes of messages, while they are put into the order of their times
_HELP = "'ls ~/.local/state/ur/black_box' lists recordings"


@dataclass(frozen=True, slots=True)
class RecordingTopic:
    """A topic with its type, the definition of the type, and how many messages of it the recording holds.

    `sender` is the node that publishes it, where that is known; `latched`: it keeps its newest message.
    """

    name: str
    type_name: str
    schema: str
    encoding: str
    count: int = 0
    sender: str = ""
    latched: bool = False


@dataclass(frozen=True, slots=True)
class StoredMessage:
    """A message as it was received, at a time in ns since 1970."""

    topic: RecordingTopic
    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class RecordingFile:
    """A recording: its topics by name, its first and last time in ns since 1970, and its metadata.

    A topic of several publishers has the sum of their messages, and the type of the last one. `complete` is False for a
    file whose end is missing: its writer was killed.
    """

    path: Path
    topics: Mapping[str, RecordingTopic]
    start: int
    end: int
    metadata: Mapping[str, Mapping[str, str]]
    complete: bool = True

    @property
    def seconds(self) -> float:
        """Its length."""
        return (self.end - self.start) / 1e9

    @property
    def kept_topics(self) -> frozenset[str]:
        """The topics whose newest message a later subscriber gets.

        Those that the recording names as latched, and all that are published seldom: others may not know of it.
        """
        most = max(1.0, self.seconds * _RARE_HZ)
        return frozenset(name for name, topic in self.topics.items() if topic.latched or topic.count <= most)

    def messages(self, begin: int = 0, topics: Set[str] | None = None) -> Iterator[StoredMessage]:
        """The messages from a time on, in the order of their times; of some topics only. Raises UserError."""
        found: dict[int, RecordingTopic] = {}
        with _reading(self.path) as file:
            for schema, channel, message in _read(file, self.path, self.complete, begin, topics):
                topic = found.get(channel.id)
                if topic is None:
                    topic = found[channel.id] = _topic_of(schema, channel)
                yield StoredMessage(topic, message.log_time, message.data)


def check_recording(path: Path) -> None:
    """Raise UserError if a file cannot be read, or does not begin as a recording. Needs no further package."""
    with _reading(path):
        pass


def open_recording(path: Path) -> RecordingFile:
    """Read what a recording holds. Raises UserError: it cannot be read, or is no MCAP file."""
    from mcap.exceptions import McapError

    with _reading(path) as file:
        try:
            summary, metadata = read_summary(file)
        except (McapError, struct.error, ValueError, EOFError, OSError, MemoryError):
            summary, metadata = None, {}
        if summary is not None and summary.statistics is not None:
            counts = summary.statistics.channel_message_counts
            channels = [
                (_topic_of(summary.schemas.get(each.schema_id), each), counts.get(each.id, 0))
                for each in summary.channels.values()
            ]
            start, end = summary.statistics.message_start_time, summary.statistics.message_end_time
            return RecordingFile(path, _count_topics(channels), start, end, metadata)
    return _survey(path)


def _survey(path: Path) -> RecordingFile:
    """A recording whose end is missing, as far as it goes."""
    topics: dict[int, RecordingTopic] = {}
    counts: dict[int, int] = {}
    times: list[int] = []
    with _reading(path) as file:
        for schema, channel, message in _read(file, path, False, 0, None):
            topics.setdefault(channel.id, _topic_of(schema, channel))
            counts[channel.id] = counts.get(channel.id, 0) + 1
            times = [min([*times[:1], message.log_time]), max([*times[1:], message.log_time])]
    if not topics:
        raise _no_recording(path, "no message in it can be read")
    counted = _count_topics([(each, counts[number]) for number, each in topics.items()])
    return RecordingFile(path, counted, times[0], times[1], {}, complete=False)


def _count_topics(channels: Sequence[tuple[RecordingTopic, int]]) -> dict[str, RecordingTopic]:
    topics: dict[str, RecordingTopic] = {}
    for topic, count in channels:
        before = topics[topic.name].count if topic.name in topics else 0
        topics[topic.name] = replace(topic, count=before + count)
    return topics


def _read(
    file: IO[bytes], path: Path, complete: bool, begin: int, topics: Set[str] | None
) -> Iterator[tuple[Schema | None, Channel, Message]]:
    from mcap.records import Channel, Message, Schema

    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    waiting: list[tuple[int, int, Channel, Message]] = []  # by time, as far as chunks overlap
    held = 0
    try:
        for number, (start, record) in enumerate(read_records(file, complete, begin, topics, channels)):
            while waiting and waiting[0][0] < start:
                _, _, channel, message = heappop(waiting)
                held -= len(message.data) + PER_RECORD
                yield schemas.get(channel.schema_id), channel, message
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels[record.channel_id]
                if record.log_time >= begin and (topics is None or channel.topic in topics):
                    heappush(waiting, (record.log_time, number, channel, record))
                    held += len(record.data) + PER_RECORD
            if held > _MOST_HELD:
                raise ValueError(f"more than {_MOST_HELD:,} bytes of messages are not in the order of their times")
    except Exception as problem:  # of the library and its decompressors, for any bytes
        if complete:
            raise _no_recording(path, str(problem) or type(problem).__name__) from None
    for _, _, channel, message in sorted(waiting, key=itemgetter(0, 1)):
        yield schemas.get(channel.schema_id), channel, message


_BAG = b"#ROSBAG V2.0"


@contextmanager
def _reading(path: Path) -> Iterator[IO[bytes]]:
    try:
        with open_file(path, sys.maxsize) as file:
            head = file.read(len(_BAG))
            if head == _BAG:
                program, folder = Path(sys.executable).with_name("rosbags-convert"), path.with_suffix("")
                command = [str(program), "--src", str(path), "--dst", str(folder)]
                convert = shlex.join([*command, "--dst-storage", "mcap", "--dst-typestore", "ros2_kilted"])
                raise user_error_about(
                    str(path), "a bag of ROS 1, expected an MCAP file", rule="bad-recording", help=convert
                )
            if not head.startswith(MAGIC):
                raise _no_recording(path, "it does not begin as one")
            file.seek(0)
            yield file
    except OSError as problem:
        raise refuse_file(path, problem, "a recording", help=_HELP) from None


def _no_recording(path: Path, reason: str) -> UserError:
    message = f"not an MCAP file that can be read ({reason})"
    return user_error_about(str(path), message, rule="bad-recording", help="a recording is a file NAME.mcap")


def _topic_of(schema: Schema | None, channel: Channel) -> RecordingTopic:
    text = schema.data.decode("utf-8", "replace") if schema is not None else ""
    return RecordingTopic(
        channel.topic,
        schema.name if schema is not None else "",
        text,
        channel.message_encoding,
        sender=channel.metadata.get(SENDER, ""),
        latched=channel.metadata.get(LATCHED) == "1",
    )


def describe_recording(recording: RecordingFile) -> Iterator[str]:
    """Its time and length, its reasons and events, and its topics."""
    began = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(recording.start / 1e9))
    broken = "" if recording.complete else ", its end is missing"
    yield f"{recording.path}: {recording.seconds:.1f} s from {began}{broken}"
    for text in recording.metadata.get("reasons", {}).values():
        yield f"  because: {printable(text)}"
    for stamp, text in sorted(recording.metadata.get("events", {}).items()):
        yield f"  {_second(stamp, recording):7.1f} s  {printable(text)}"
    width = max((len(name) for name in recording.topics), default=0)
    for name, topic in sorted(recording.topics.items()):
        yield f"  {printable(name):<{width}}  {topic.count:6} messages  {printable(topic.type_name)}"


def _second(stamp: str, recording: RecordingFile) -> float:
    try:
        return float(stamp) - recording.start / 1e9
    except ValueError:
        return 0.0
