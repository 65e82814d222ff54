"""YDLIDAR X2 and X4: "YDLIDAR X2 Development Manual", "YDLIDAR X4 Development Manual".

Packets: AA 55, a kind (bit 0: the head passed its zero), the number of samples, the angles of the first and the last
one in 64ths of a degree (shifted by one bit), a checksum, and samples: distances in quarters of mm. Numbers are
little-endian, angles clockwise; each angle needs a correction that depends on the distance.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ur_nodes.drivers.frames import MORE, NONE, FrameReader
from ur_nodes.drivers.lidars.lidar import time_on_line
from ur_nodes.drivers.readings import MeasuredBeams, Reading

_HEAD = struct.Struct("<HBBHHH")
_MOST = 255  # samples of a packet
_START, _STOP = b"\xa5\x60", b"\xa5\x65"


class Ydlidar:
    """See LidarProtocol. An X2 has no commands, and ignores those of an X4."""

    name = "YDLIDAR X2 or X4"
    baud = 128000
    dtr = True

    def __init__(self) -> None:
        self._frames = FrameReader(b"\xaa\x55", _measure, _is_valid, _HEAD.size + 2 * _MOST)

    @property
    def rejected(self) -> int:
        return self._frames.rejected

    def greet(self) -> bytes:
        """Start to scan."""
        return _STOP + _START

    def leave(self) -> bytes:
        """Stop scanning."""
        return _STOP

    def take(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.take(data):
            _, _, count, first, last, _ = _HEAD.unpack_from(frame)
            millimetres = np.frombuffer(frame, "<u2", count, _HEAD.size) / 4.0
            begin, span = (first >> 1) / 64.0, ((last >> 1) - (first >> 1)) / 64.0 % 360.0
            degrees = begin + span * np.arange(count) / max(1, count - 1) + correction(millimetres)
            ranges = np.where(millimetres > 0.0, millimetres / 1000.0, np.inf)
            sending = time_on_line(len(frame), self.baud)
            yield MeasuredBeams(np.radians(degrees % 360.0), ranges, np.zeros(0), clockwise=True, sending=sending)


def correction(millimetres: NDArray[np.float64]) -> NDArray[np.float64]:
    """The second-level correction of the manual, degrees (n,) for distances (n,); 0 for none."""
    distance = np.where(millimetres > 0.0, millimetres, 155.3)
    return np.degrees(np.arctan(21.8 * (155.3 - distance) / (155.3 * distance)))


def _measure(frame: bytes) -> int:
    if len(frame) < 4:
        return MORE
    return _HEAD.size + 2 * frame[3] if frame[3] else NONE


def _is_valid(frame: bytes) -> bool:
    """The exclusive or of all words, but the checksum itself, is the checksum."""
    words = np.frombuffer(frame, "<u2")
    return int(np.bitwise_xor.reduce(words)) == 0
