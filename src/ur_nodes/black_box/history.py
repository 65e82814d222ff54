"""Messages of topics in a ring: bounded in bytes and in age, with the newest of each topic kept.

Times are ns of a clock that is never set. A record has a kind (topic, message or event), the number of its topic, the
time at which it was put into the ring, the time of its message, and its data.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from ur.source.foreign.json_values import read_json, write_json

_HEADER = struct.Struct("<8sQ")
_COUNTER = struct.Struct("<Q")
_LENGTH = struct.Struct("<I")
_MAGIC = b"urring01"
_TAIL, _HEAD, _DATA = 16, 24, 64
_PIECE = 1 << 20  # bytes


def copy_ring(block: mmap.mmap) -> Ring:
    """Copy a ring to which another process appends meanwhile: the records that stayed whole."""
    copy = bytearray(block)
    tail = min(_COUNTER.unpack_from(block, _TAIL)[0], _COUNTER.unpack_from(copy, _HEAD)[0])
    _COUNTER.pack_into(copy, _TAIL, tail)  # what was dropped while it was copied may be overwritten
    return Ring(memoryview(copy), kept=True)


class Ring:
    """A ring in a writable block, which is cleared unless it is `kept`.

    Raises ValueError if a kept block has no ring.
    """

    def __init__(self, block: memoryview, *, kept: bool = False) -> None:
        self._block = block
        if not kept:
            _HEADER.pack_into(block, 0, _MAGIC, len(block) - _DATA)
            self._set(_TAIL, 0)
            self._set(_HEAD, 0)
        magic, size = _HEADER.unpack_from(block, 0)
        self.size = int(size)
        if magic != _MAGIC or self.size != len(block) - _DATA:
            raise ValueError("the block holds no ring")
        self._tail, self._head = self._get(_TAIL), self._get(_HEAD)
        if not 0 <= self._head - self._tail <= self.size:
            raise ValueError("the ring is damaged")

    @property
    def free(self) -> int:
        """The free bytes for records, each with 4 more."""
        return self.size - (self._head - self._tail)

    def append(self, *parts: bytes) -> None:
        """Append a record. Raises ValueError if it does not fit."""
        length = sum(map(len, parts))
        if length + _LENGTH.size > self.free:
            raise ValueError("no room")
        place = self._head
        for part in (_LENGTH.pack(length), *parts):
            start = _DATA + place % self.size
            first = min(len(part), len(self._block) - start)
            self._block[start : start + first] = part[:first]
            if first < len(part):
                self._block[_DATA : _DATA + len(part) - first] = part[first:]
            place += len(part)
        self._head = place
        self._set(_HEAD, place)

    def oldest(self, most: int | None = None) -> bytes | None:
        """Return the oldest record, or its first `most` bytes; None if empty."""
        if self._tail == self._head:
            return None
        length = self._length(self._tail)
        return self._read(self._tail + _LENGTH.size, length if most is None else min(length, most))

    def drop(self) -> None:
        """Drop the oldest record. Its memory is given back to the system, by pieces of 1 MB, where that is mapped."""
        piece = (_DATA + self._tail % self.size) // _PIECE * _PIECE
        self._tail += _LENGTH.size + self._length(self._tail)
        self._set(_TAIL, self._tail)
        left = not 0 <= _DATA + self._tail % self.size - piece < _PIECE
        dead = (_DATA + self._tail - piece) % self.size <= self.free  # else the newest records are in it
        if left and dead and piece and isinstance(self._block.obj, mmap.mmap):
            self._block.obj.madvise(mmap.MADV_REMOVE, piece, min(_PIECE, len(self._block) - piece))

    def records(self) -> Iterator[bytes]:
        """Return all records, oldest first; those after damage are left out."""
        place = self._tail
        while place < self._head:
            length = self._length(place)
            if place + _LENGTH.size + length > self._head:
                return
            yield self._read(place + _LENGTH.size, length)
            place += _LENGTH.size + length

    def _length(self, offset: int) -> int:
        length: int = _LENGTH.unpack(self._read(offset, _LENGTH.size))[0]
        return length

    def _read(self, offset: int, length: int) -> bytes:
        start = _DATA + offset % self.size
        first = min(length, len(self._block) - start)
        data = bytes(self._block[start : start + first])
        return data if first == length else data + bytes(self._block[_DATA : _DATA + length - first])

    def _get(self, offset: int) -> int:
        value: int = _COUNTER.unpack_from(self._block, offset)[0]
        return value

    def _set(self, offset: int, value: int) -> None:
        _COUNTER.pack_into(self._block, offset, value)


SECOND = 1_000_000_000
_RECORD = struct.Struct("<BHQQ")
_TOPIC, _MESSAGE, _EVENT = 1, 2, 3
_MOST_TOPICS = 60_000
_KEPT_SHARE = 8  # the newest message of a topic is kept while it has at most this fraction of the ring
LARGE_BYTES = 200_000
"""Bytes of a message from which on its topic is taken once a second."""

_LARGE_TYPES = frozenset({"Image", "CompressedImage", "PointCloud", "PointCloud2", "DisparityImage", "Packet"})
_LARGE_PERIOD = SECOND


@dataclass(frozen=True, slots=True)
class HistoryTopic:
    """A topic of a sender, with its type and the definition of the type."""

    name: str
    type_name: str
    schema: str
    sender: str = ""
    latched: bool = False


@dataclass(frozen=True, slots=True)
class HistoryMessage:
    """A message of a topic as it was received at a time in ns; one older than the history has the time of its begin."""

    topic: HistoryTopic
    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class HistoryEvent:
    """An event, as text for users."""

    time: int
    text: str


class MessageHistory:
    """The last `seconds` of messages in a ring, or fewer if they do not fit.

    Messages of pictures and clouds, and others as large, are recorded once a second. `left_out` counts the messages
    that are not in the ring although they are younger: by topic.
    """

    def __init__(self, ring: Ring, seconds: float = 120.0) -> None:
        self._ring = ring
        self._age = int(seconds * SECOND)
        self._numbers: dict[HistoryTopic, int] = {}
        self._topics: dict[int, HistoryTopic] = {}
        self._counts: dict[int, int] = {}
        self._large: dict[int, int] = {}
        self._current: dict[tuple[str, str], int] = {}
        self.left_out: dict[str, int] = {}

    def note(self, topic: HistoryTopic, time: int, data: bytes) -> None:
        """Record a message."""
        number = self._numbers.get(topic)
        if number is None:
            number = self._add_topic(topic, time)
        if len(data) > LARGE_BYTES or topic.type_name.rpartition("/")[2] in _LARGE_TYPES:
            last = self._large.get(number)
            if last is not None and 0 <= time - last < _LARGE_PERIOD:
                return
            self._large[number] = time
        if number < 0 or not self._append(_MESSAGE, number, time, time, data):
            self.left_out[topic.name] = self.left_out.get(topic.name, 0) + 1
        else:
            self._counts[number] = self._counts.get(number, 0) + 1

    def note_event(self, time: int, text: str) -> None:
        """Record an event."""
        self._append(_EVENT, 0, time, time, text.encode())

    def _add_topic(self, topic: HistoryTopic, time: int) -> int:
        # One whose type has changed is another topic.
        number = len(self._numbers) + 1
        if number > _MOST_TOPICS or not self._append(_TOPIC, number, time, time, write_json(topic).encode()):
            number = -1
        self._numbers[topic] = number
        self._topics[number] = topic
        self._current[topic.name, topic.sender] = number
        return number

    def _append(self, kind: int, number: int, put: int, time: int, data: bytes) -> bool:
        head = _RECORD.pack(kind, number, put, time)
        needed = len(head) + len(data) + 4
        if needed > self._ring.size // 2:
            return False
        self._make_room(needed, put)
        self._ring.append(head, data)
        return True

    def _make_room(self, needed: int, now: int) -> None:
        """Drop the oldest records; move descriptions of topics, and the newest message of each, to the end."""
        kept: list[tuple[int, int, int, bytes]] = []
        room = 0
        while True:
            head = self._ring.oldest(_RECORD.size)
            if head is None:
                break
            kind, number, put, time = _RECORD.unpack(head)
            if self._ring.free >= needed + room and now - put <= self._age:
                break
            if kind == _MESSAGE:
                self._counts[number] -= 1
            if self._is_kept(kind, number):
                whole = self._ring.oldest() or b""
                size = len(whole) + 4
                if (kind == _TOPIC or size <= self._ring.size // _KEPT_SHARE) and room + size <= self._ring.size // 2:
                    kept.append((kind, number, time, whole[_RECORD.size :]))
                    room += size
            self._ring.drop()
        for kind, number, time, data in kept:
            self._ring.append(_RECORD.pack(kind, number, now, time), data)
            if kind == _MESSAGE:
                self._counts[number] += 1

    def _is_kept(self, kind: int, number: int) -> bool:
        topic = self._topics.get(number)
        current = topic is not None and self._current.get((topic.name, topic.sender)) == number
        if kind == _TOPIC:
            return current or self._counts.get(number, 0) > 0
        return kind == _MESSAGE and not self._counts[number] and current


def read_history(ring: Ring) -> Iterator[HistoryMessage | HistoryEvent]:
    """Read the messages and events of a ring, by time."""
    found: list[tuple[int, int, int, bytes]] = []
    topics: dict[int, HistoryTopic] = {}
    begin: int | None = None
    for record in ring.records():
        kind, number, put, time = _RECORD.unpack_from(record)
        begin = put if begin is None or put < begin else begin
        data = record[_RECORD.size :]
        if kind == _TOPIC:
            topics[number] = read_json(data, HistoryTopic)
        else:
            found.append((time, kind, number, data))
    for time, kind, number, data in sorted(found, key=lambda each: each[0]):
        moment = max(time, begin or 0)
        if kind == _EVENT:
            yield HistoryEvent(moment, data.decode("utf-8", "replace"))
        elif number in topics:
            yield HistoryMessage(topics[number], moment, data)
