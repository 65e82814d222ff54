"""A ring of records in a block of memory, oldest first, which a second process can read after the end of the first.

The block begins with a header: a magic number, the size of what follows, and how many bytes were ever dropped and
appended. A record is its length (u32) and its bytes, and may wrap around the end. The header changes last, so that a
writer that is killed leaves whole records only.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator

_HEADER = struct.Struct("<8sQ")
_COUNTER = struct.Struct("<Q")
_LENGTH = struct.Struct("<I")
_MAGIC = b"urring01"
_TAIL, _HEAD, _DATA = 16, 24, 64


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
        """Drop the oldest record."""
        self._tail += _LENGTH.size + self._length(self._tail)
        self._set(_TAIL, self._tail)

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
