"""YDLIDAR X2 and X4: "YDLIDAR X2 Development Manual", "YDLIDAR X4 Development Manual".

Packets: AA 55, a kind (bit 0: the head passed its zero), the number of samples, the angles of the first and the last
one in 64ths of a degree (shifted by one bit), a checksum, and samples: distances in quarters of mm. Numbers are
little-endian, angles clockwise; each angle needs a correction that depends on the distance.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from ur_nodes.drivers.frames import MORE, NONE, FrameReader
from ur_nodes.drivers.lidars.lidar import time_on_line
from ur_nodes.drivers.lidars.turning_head import TurningHead
from ur_nodes.drivers.readings import MeasuredBeams, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

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

    def handshake(self) -> bytes:
        """Start to scan."""
        return _STOP + _START

    def shutdown(self) -> bytes:
        """Stop scanning."""
        return _STOP

    def receive(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.receive(data):
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


# Stand-in: the tables of the X4's "Development Manual".


class YdlidarFirmware(TurningHead):
    """An X4: packets of at most 40 samples, and one of a single sample at its zero."""

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._scans = False

    def receive(self, data: bytes) -> bytes:
        if b"\xa5\x65" in data:
            self._scans = False
        if b"\xa5\x60" in data:
            self._scans = True
            return bytes.fromhex("a55a0500004081")
        return b""

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        sent, packet = b"", list[tuple[int, float]]()
        for n, mm in zip(beams.tolist(), millimetres.tolist(), strict=True):
            if packet and (n % 360 == 0 or len(packet) == 40 or packet[0][0] % 360 == 0):
                sent += self._packet(packet)
                packet = []
            packet.append((n, mm))
        return sent + self._packet(packet) if self._scans and packet else sent if self._scans else b""

    def measure(self, beams: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """See TurningHead. The head sees what is where the host puts it, which corrects the angle by the distance."""
        raw = np.radians(beams % 360)
        distances = self.look(raw)
        for _ in range(3):
            distances = self.look(raw + _correction(distances))
        return distances

    @staticmethod
    def _packet(points: list[tuple[int, float]]) -> bytes:
        first, last = (points[k][0] % 360 * 64 * 2 + 1 for k in (0, -1))
        kind = 1 if points[0][0] % 360 == 0 else 0
        words = [0x55AA, kind | len(points) << 8, first, last, *(round(mm * 4) for _, mm in points)]
        total = 0
        for word in words:
            total ^= word
        return struct.pack(f"<{len(words) + 1}H", *words[:4], total, *words[4:])


def _correction(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The manual's correction of the angles (rad) of distances (mm); 0 where nothing was measured."""
    d = np.maximum(distances, 1.0)
    return np.where(distances > 0.0, np.arctan(21.8 * (155.3 - d) / (155.3 * d)), 0.0)
