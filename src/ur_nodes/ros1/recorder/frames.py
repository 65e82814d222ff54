"""Messages in the stream of a connection of ROS 1: each is its length (u32) and its bytes."""

from __future__ import annotations

import struct

MOST_BYTES = 1 << 26
"""Bytes of one message."""

_LENGTH = struct.Struct("<I")


class FrameError(Exception):
    """The stream is none of messages."""


class Frames:
    """Cuts a stream into messages; what is incomplete waits for the rest."""

    def __init__(self) -> None:
        self._rest = bytearray()

    def feed(self, data: memoryview) -> list[bytes]:
        """The messages that are complete now. Raises FrameError."""
        if self._rest:
            self._rest += data
            with memoryview(self._rest) as whole:
                found, used = _cut(whole)
            del self._rest[:used]
            return found
        found, used = _cut(data)
        if used < len(data):
            self._rest += data[used:]
        return found


def _cut(data: memoryview) -> tuple[list[bytes], int]:
    found: list[bytes] = []
    place = 0
    while len(data) - place >= _LENGTH.size:
        (length,) = _LENGTH.unpack_from(data, place)
        if length > MOST_BYTES:
            raise FrameError(f"a message of {length} bytes, expected at most {MOST_BYTES}")
        end = place + _LENGTH.size + length
        if end > len(data):
            break
        found.append(bytes(data[place + _LENGTH.size : end]))
        place = end
    return found, place
