"""LDROBOT LD06 and LD19: "LD06 Development Manual" and "LD19 Development Manual".

It sends frames of 47 bytes by itself: 54, 2C, the speed in degrees a second, the angle of the first of 12 points, for
each point a distance in mm and its confidence, the angle of the last one, a time in ms, and a CRC of 8 bits. Numbers
are little-endian, angles hundredths of a degree, clockwise.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np

from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.lidars.lidar import SendingLidar
from ur_nodes.drivers.readings import MeasuredBeams, Reading

POINTS = 12
_SIZE = 47
_POLYNOMIAL = 0x4D
_HEAD = struct.Struct("<BBHH")
_POINT = np.dtype([("distance", "<u2"), ("confidence", "u1")])


def _make_table() -> bytes:
    table = bytearray()
    for value in range(256):
        for _ in range(8):
            value = (value << 1) ^ (_POLYNOMIAL if value & 0x80 else 0)
        table.append(value & 0xFF)
    return bytes(table)


_TABLE = _make_table()


class LdRobot(SendingLidar):
    """See LidarProtocol."""

    name = "LDROBOT LD06 or LD19"
    baud = 230400
    dtr = True

    def __init__(self) -> None:
        self._frames = FrameReader(b"\x54\x2c", fixed(_SIZE), lambda frame: check(frame[:-1]) == frame[-1], _SIZE)

    def take(self, data: bytes) -> Iterator[Reading]:
        """See LidarProtocol."""
        for frame in self._frames.take(data):
            _, _, speed, first = _HEAD.unpack_from(frame)
            last = struct.unpack_from("<H", frame, 42)[0]
            points = np.frombuffer(frame, _POINT, POINTS, 6)
            span = (last - first) % 36000
            phases = np.radians((first + span * np.arange(POINTS) / (POINTS - 1)) % 36000 / 100.0)
            ranges = np.where(points["distance"] > 0, points["distance"] / 1000.0, np.inf)
            turn_time = 360.0 / speed if speed else 0.0
            yield MeasuredBeams(
                phases, ranges, points["confidence"].astype(np.float64), clockwise=True, turn_time=turn_time
            )


def check(data: bytes) -> int:
    """The CRC of 8 bits, polynomial 4D, which begins with 0."""
    value = 0
    for byte in data:
        value = _TABLE[value ^ byte]
    return value
