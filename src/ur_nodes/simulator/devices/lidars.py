"""Stand-ins of lidars: the beams that a head has passed since the last tick, in the bytes of their protocols.

RPLIDAR: the figures 4-4 and following of Slamtec's "Interface Protocol", A1M8. LD06: the tables of LDROBOT's manual.
XV-11: the packet of 22 bytes of the Neato hacking wiki. YDLIDAR: the tables of the X4's "Development Manual".
"""

from __future__ import annotations

import math
import struct
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from ur_nodes.simulator.devices.plant import Plant

_PER_TURN = 360  # beams, a degree apart
_MOST = 180  # beams of a tick, after a stall


class TurningHead(ABC):
    """A head that turns at the rate of the base file and measures once a degree, counted from its own zero."""

    covers = frozenset(("lidar",))
    clockwise = True
    turns = True
    """False: the head rests."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        lidar = plant.base.lidar
        assert lidar is not None  # the bench gives lidars to bases that have one
        self._lidar = lidar
        self._step = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        self._time = plant.time
        self._beam = 0  # the next one, counted from the start

    @abstractmethod
    def take(self, data: bytes) -> bytes:
        """See Firmware."""

    @abstractmethod
    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        """The bytes for beams, by their numbers since the start; 0.0 mm: nothing was measured."""

    def tick(self) -> bytes:
        rate = self._lidar.rate * _PER_TURN
        count = int((self._plant.time - self._time) * rate + 1e-6)
        self._time += count / rate
        if not count or not self.turns:
            return b""
        beams = self._beam + np.arange(count)[-_MOST:]
        self._beam += count
        return self.pack(beams, self.measure(beams))

    def measure(self, beams: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """The distances (n,) in mm of beams (n,) by their numbers."""
        return self.look(np.radians(beams % _PER_TURN))

    def look(self, phases: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The distances (n,) in mm where the head has turned by so much (n,); 0.0: nothing is in reach."""
        angles = -phases if self.clockwise else phases
        index = np.rint((angles - self._lidar.angle_min) % (2.0 * math.pi) / self._step).astype(np.int64)
        index %= round(2.0 * math.pi / self._step)
        inside = index < self._lidar.samples
        ranges = self._plant.ranges()[np.where(inside, index, 0)]
        return np.where(inside & np.isfinite(ranges), ranges * 1000.0, 0.0)


class RplidarFirmware(TurningHead):
    """An A1: standard and express scans."""

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._scan = ""
        self._data = b""
        self._waiting: list[tuple[int, float]] = []
        self._first = True
        self.requests = b""

    def take(self, data: bytes) -> bytes:
        self.requests = (self.requests + data)[-1000:]
        self._data += data
        answer = b""
        while (at := self._data.find(b"\xa5")) >= 0 and len(self._data) > at + 1:
            command = self._data[at + 1]
            size = 2
            if command >= 0x80:
                if len(self._data) < at + 3:
                    break
                size = 4 + self._data[at + 2]
            if len(self._data) < at + size:
                break
            self._data = self._data[at + size :]
            answer += self._answer(command)
        return answer

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        if self._scan == "standard":
            return b"".join(
                struct.pack("<BHH", 60 | (2 - (n % 360 == 0)), (n % 360 * 64) * 2 + 1, round(mm * 4))
                for n, mm in zip(beams.tolist(), millimetres.tolist(), strict=True)
            )
        if self._scan != "express":
            return b""
        self._waiting += zip(beams.tolist(), millimetres.tolist(), strict=True)
        sent = b""
        while len(self._waiting) >= 32:
            sent += self._capsule(self._waiting[:32])
            del self._waiting[:32]
        return sent

    def _capsule(self, beams: list[tuple[int, float]]) -> bytes:
        start = beams[0][0] % 360 * 64 | (0x8000 if self._first else 0)
        self._first = False
        body = struct.pack("<H", start)
        for (_, one), (_, other) in zip(beams[::2], beams[1::2], strict=True):
            body += struct.pack("<HHB", round(one) << 2, round(other) << 2, 0)
        total = 0
        for byte in body:
            total ^= byte
        return bytes((0xA0 | total & 15, 0x50 | total >> 4)) + body

    def _answer(self, command: int) -> bytes:
        if command in (0x20, 0x82):
            self._scan, self._first, self._waiting = ("standard" if command == 0x20 else "express"), True, []
            return bytes.fromhex("a55a0500004081" if command == 0x20 else "a55a5400004082")
        if command == 0x25:
            self._scan = ""
        if command == 0x50:
            return bytes.fromhex("a55a1400000004") + bytes((0x18, 29, 1, 7)) + bytes(range(16))
        return bytes.fromhex("a55a0300000006000000") if command == 0x52 else b""


class PacketHead(TurningHead):
    """A head that listens to nothing, and sends packets of `size` beams."""

    size: ClassVar[int]

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._waiting: list[tuple[int, float]] = []

    @abstractmethod
    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        """The bytes of a packet of beams, each its number since the start and a distance in mm."""

    def take(self, data: bytes) -> bytes:
        return data[:0]

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        self._waiting += zip(beams.tolist(), millimetres.tolist(), strict=True)
        sent = b""
        while len(self._waiting) >= self.size:
            sent += self.packet(self._waiting[: self.size])
            del self._waiting[: self.size]
        return sent


class LdRobotFirmware(PacketHead):
    """An LD06."""

    size = 12

    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        head = struct.pack("<BBHH", 0x54, 0x2C, round(self._lidar.rate * 360), points[0][0] % 360 * 100)
        body = b"".join(struct.pack("<HB", round(mm), 200) for _, mm in points)
        frame = head + body + struct.pack("<HH", points[-1][0] % 360 * 100, round(self._plant.time * 1000) % 30000)
        return frame + bytes((_crc8(frame),))


class Xv11Firmware(PacketHead):
    """The lidar of an XV-11 on a controller that turns it."""

    clockwise = False
    size = 4

    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        packet = struct.pack("<BBH", 0xFA, 0xA0 + points[0][0] % 360 // 4, round(self._lidar.rate * 60 * 64))
        for _, mm in points:
            packet += struct.pack("<HH", round(mm) if 0 < mm < 16384 else 0x8035, 300)
        total = 0
        for (word,) in struct.iter_unpack("<H", packet):
            total = total * 2 + word
        return packet + struct.pack("<H", (total % 32768 + total // 32768) % 32768)


class YdlidarFirmware(TurningHead):
    """An X4: packets of at most 40 samples, and one of a single sample at its zero."""

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._scans = False

    def take(self, data: bytes) -> bytes:
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
        raw = np.radians(beams % _PER_TURN)
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


def _crc8(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value * 2) ^ (0x14D if value & 0x80 else 0)
    return value
