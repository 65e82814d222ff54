"""Recordings: MCAP files, of the black box and of other recorders. What they hold is checked while it is read.

The file is read piece by piece: a recording may be larger than the memory.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ur.source.diagnostic import UserError, error_about

if TYPE_CHECKING:
    from mcap.reader import McapReader
    from mcap.records import Channel, Message, Schema


@dataclass(frozen=True, slots=True)
class RecordingTopic:
    """A topic with its type, the definition of the type, and how many messages of it the recording holds."""

    name: str
    type_name: str
    schema: str
    encoding: str
    count: int = 0


@dataclass(frozen=True, slots=True)
class StoredMessage:
    """A message as it was received, at a time in ns since 1970."""

    topic: RecordingTopic
    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class RecordingFile:
    """A recording: its topics by name, its first and last time in ns since 1970, and its metadata.

    `complete` is False for a file whose end is missing: its writer was killed.
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

    def messages(self, begin: int = 0, topics: Set[str] | None = None) -> Iterator[StoredMessage]:
        """The messages from a time on, in the order of their times; of some topics only. Raises UserError."""
        with _reading(self.path) as file:
            for schema, channel, message in _read(file, self.path, self.complete, begin, topics):
                topic = self.topics.get(channel.topic) or _topic_of(schema, channel, 0)
                yield StoredMessage(topic, message.log_time, message.data)


def open_recording(path: Path) -> RecordingFile:
    """Read what a recording holds. Raises UserError: it cannot be read, or is no MCAP file."""
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    with _reading(path) as file:
        try:
            reader = make_reader(file, validate_crcs=False)
            summary = reader.get_summary()
            metadata = {each.name: dict(each.metadata) for each in reader.iter_metadata()}
        except (McapError, struct.error, ValueError, EOFError, OSError):
            summary, metadata = None, {}
        if summary is not None and summary.statistics is not None:
            counts = summary.statistics.channel_message_counts
            channels = [
                (summary.schemas.get(each.schema_id), each, counts.get(each.id, 0))
                for each in summary.channels.values()
            ]
            topics = {each.topic: _topic_of(schema, each, count) for schema, each, count in channels}
            start, end = summary.statistics.message_start_time, summary.statistics.message_end_time
            return RecordingFile(path, topics, start, end, metadata)
    return _survey(path)


def _survey(path: Path) -> RecordingFile:
    """A recording whose end is missing, as far as it goes."""
    topics: dict[str, RecordingTopic] = {}
    counts: dict[str, int] = {}
    times: list[int] = []
    with _reading(path) as file:
        for schema, channel, message in _read(file, path, False, 0, None):
            topics.setdefault(channel.topic, _topic_of(schema, channel, 0))
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            times = [min([*times[:1], message.log_time]), max([*times[1:], message.log_time])]
    if not topics:
        raise _no_recording(path, "no message in it can be read")
    counted = {
        name: RecordingTopic(name, each.type_name, each.schema, each.encoding, counts[name])
        for name, each in topics.items()
    }
    return RecordingFile(path, counted, times[0], times[1], {}, complete=False)


def _read(
    file: IO[bytes], path: Path, complete: bool, begin: int, topics: Set[str] | None
) -> Iterator[tuple[Schema | None, Channel, Message]]:
    from mcap.exceptions import McapError
    from mcap.reader import NonSeekingReader, make_reader

    chosen = sorted(topics) if topics is not None else None
    reader: McapReader = make_reader(file) if complete else NonSeekingReader(file)
    try:
        yield from reader.iter_messages(topics=chosen, starting_at=begin or None, log_time_order=complete)
    except (McapError, struct.error, EOFError, ValueError, OSError) as problem:
        if complete:
            raise _no_recording(path, str(problem) or type(problem).__name__) from None


@contextmanager
def _reading(path: Path) -> Iterator[IO[bytes]]:
    try:
        with path.open("rb") as file:
            if file.read(1) != b"\x89":
                raise _no_recording(path, "it does not begin as one")
            file.seek(0)
            yield file
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(
            error_about(
                str(path), reason, rule="unreadable-file", help="'ls ~/.local/state/ur/black_box' lists recordings"
            )
        ) from None


def _no_recording(path: Path, reason: str) -> UserError:
    message = f"not an MCAP file that can be read ({reason})"
    return UserError(error_about(str(path), message, rule="bad-recording", help="a recording is a file NAME.mcap"))


def _topic_of(schema: Schema | None, channel: Channel, count: int) -> RecordingTopic:
    text = schema.data.decode("utf-8", "replace") if schema is not None else ""
    return RecordingTopic(
        channel.topic, schema.name if schema is not None else "", text, channel.message_encoding, count
    )
