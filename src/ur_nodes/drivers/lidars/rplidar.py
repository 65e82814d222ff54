"""Slamtec RPLIDAR: "RPLIDAR Interface Protocol and Application Notes", requests, standard and express scans.

A request is A5 and a command, with a payload its length, the payload and the exclusive or of all. An answer begins with
A5 5A, 30 bits of length, 2 of mode, and its kind. Angles are clockwise.

Standard scan: samples of 5 bytes: quality and the flag of a new turn with its inverse, the angle in 64ths of a degree
with a bit that is 1, the distance in quarters of mm. Express scan (legacy): packets of 84 bytes, A and 5 in the upper
halves of the first two bytes, the checksum in their lower halves, the angle of the first of 32 samples, and 16 cabins
of two distances in mm with corrections of their angles, 6 bits, in eighths of a degree. The document calls the first of
these bits a sign; Slamtec's own SDK, with which its lidars are used, subtracts all six (handler_capsules.cpp), as here.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.lidars.lidar import time_on_line
from ur_nodes.drivers.lidars.turning_head import TurningHead
from ur_nodes.drivers.readings import DeviceIdentity, MeasuredBeams, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

_STOP, _SCAN, _INFO, _HEALTH = b"\xa5\x25", b"\xa5\x20", b"\xa5\x50", b"\xa5\x52"
_EXPRESS = b"\xa5\x82\x05\x00\x00\x00\x00\x00\x22"
_PACE = b"\xa5\xf0\x02\x94\x02\xc1"  # motor: 660 of 1023, where an A2 or A3 has its own control
_STILL = b"\xa5\xf0\x02\x00\x00\x57"
_PAUSE = bytes(64)  # 5.5 ms in which an answer leaves; what is no request is ignored
_ANSWERS = {0x04: 20, 0x06: 3}  # bytes of what is no scan: information, health
_HEAD = 7
_SAMPLE = np.dtype([("quality", "u1"), ("angle", "<u2"), ("distance", "<u2")])
_RUN = 5  # samples in a row whose check bits are right, from which on they are believed
_MOST = 4096
_PACKET, _CABINS = 84, 16
_CABIN = np.dtype([("first", "<u2"), ("second", "<u2"), ("corrections", "u1")])


class _Rplidar:
    """Requests, and answers that are no scan: both kinds of scan share them."""

    name = "RPLIDAR"
    baud = 115200
    dtr = False  # the motor of an A1 turns then

    def __init__(self) -> None:
        self._answers = FrameReader(b"\xa5\x5a", _measure_answer, lambda _: True, _HEAD + 20)

    def shutdown(self) -> bytes:
        """Stop the scan and the motor."""
        return _STOP + _STILL

    def read_answers(self, data: bytes) -> Iterator[Reading]:
        """Information and health, of all that arrives."""
        for frame in self._answers.receive(data):
            body = frame[_HEAD:]
            if frame[6] == 0x04:
                yield DeviceIdentity(f"model {body[0] >> 4}.{body[0] & 15}, firmware {body[2]}.{body[1]:02d}")
            elif body[0] == 2:
                code = int.from_bytes(body[1:3], "little")
                yield DeviceIdentity(
                    "", f"it reports that it is broken (error {code:#06x}); unplug it and plug it in again"
                )


class RplidarStandard(_Rplidar):
    """See LidarProtocol."""

    def __init__(self) -> None:
        super().__init__()
        self._buffer = b""
        self._synced = False
        self.rejected = 0

    def handshake(self) -> bytes:
        """Stop, ask who and how it is, start the motor and the scan."""
        self._buffer, self._synced = b"", False
        return _STOP + _PAUSE + _INFO + _PAUSE + _HEALTH + _PAUSE + _PACE + _SCAN

    def receive(self, data: bytes) -> Iterator[Reading]:
        yield from self.read_answers(data)
        self._buffer = (self._buffer + data)[-_MOST:]
        while len(self._buffer) >= (5 if self._synced else 5 * _RUN):
            right = _count_right(self._buffer)
            if right < (1 if self._synced else _RUN):
                self.rejected += self._synced
                self._synced = False
                self._buffer = self._buffer[1:]
                continue
            self._synced = True
            samples = np.frombuffer(self._buffer, _SAMPLE, right)
            self._buffer = self._buffer[5 * right :]
            phases = np.radians((samples["angle"] >> 1) / 64.0 % 360.0)
            ranges = np.where(samples["distance"] > 0, samples["distance"] / 4000.0, np.inf)
            yield MeasuredBeams(phases, ranges, (samples["quality"] >> 2).astype(np.float64), clockwise=True)


class RplidarExpress(_Rplidar):
    """See LidarProtocol. The angles of a packet need the beginning of the next one, so it is given with that."""

    def __init__(self) -> None:
        super().__init__()
        self._packets = FrameReader(b"", fixed(_PACKET), _is_packet, _PACKET)
        self._last: tuple[float, NDArray[np.void]] | None = None
        self._rejected = self.rejected = 0
        self._runs = False

    def handshake(self) -> bytes:
        """Stop, ask who and how it is, start the motor and the express scan."""
        self._last, self._runs = None, False
        self._packets.clear()
        return _STOP + _PAUSE + _INFO + _PAUSE + _HEALTH + _PAUSE + _PACE + _EXPRESS

    def receive(self, data: bytes) -> Iterator[Reading]:
        yield from self.read_answers(data)
        for packet in self._packets.receive(data):
            word = int.from_bytes(packet[2:4], "little")
            start, cabins = (word & 0x7FFF) / 64.0, np.frombuffer(packet, _CABIN, _CABINS, 4)
            gap = self._packets.rejected != self._rejected  # a packet is missing, and the angles of its beams
            self.rejected += gap and self._runs
            self._rejected, self._runs = self._packets.rejected, True
            last = None if gap or word & 0x8000 else self._last
            self._last = (start, cabins)
            if last is not None:
                yield read_cabins(last[1], last[0], (start - last[0]) % 360.0)


def read_cabins(cabins: NDArray[np.void], start: float, span: float) -> MeasuredBeams:
    """The 32 beams of a packet's cabins: from `start` on, `span` degrees to that of the next packet."""
    words = np.stack((cabins["first"], cabins["second"]), 1)
    low = np.stack((cabins["corrections"] & 15, cabins["corrections"] >> 4), 1)
    corrections = (low | (words & 3).astype(np.uint8) << 4).ravel() / 8.0
    distances = (words >> 2).ravel()
    degrees = (start + span * np.arange(distances.size) / distances.size - corrections) % 360.0
    ranges = np.where(distances > 0, distances / 1000.0, np.inf)
    sending = time_on_line(_PACKET, _Rplidar.baud)
    return MeasuredBeams(
        np.radians(degrees), ranges, np.zeros(0), clockwise=True, behind=math.radians(span), sending=sending
    )


def _count_right(buffer: bytes) -> int:
    """The number of samples at the beginning whose check bits are right: the flag and its inverse, and a 1."""
    samples = np.frombuffer(buffer, _SAMPLE, len(buffer) // 5)
    flags = samples["quality"] & 3
    right = ((flags == 1) | (flags == 2)) & (samples["angle"] & 1 == 1) & (samples["angle"] >> 1 < 360 * 64)
    return len(right) if right.all() else int(np.argmin(right))


def _measure_answer(frame: bytes) -> int:
    if len(frame) < _HEAD:
        return 0
    size = int.from_bytes(frame[2:6], "little") & 0x3FFFFFFF
    return _HEAD + size if _ANSWERS.get(frame[6]) == size else -1


def _is_packet(packet: bytes) -> bool:
    if packet[0] >> 4 != 0xA or packet[1] >> 4 != 0x5:
        return False
    return reduce(xor, packet[2:]) == (packet[0] & 15 | packet[1] << 4 & 0xF0)


# Stand-in: the figures 4-4 and following of Slamtec's "Interface Protocol", A1M8.


class RplidarFirmware(TurningHead):
    """An A1: standard and express scans."""

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._scan = ""
        self._data = b""
        self._waiting: list[tuple[int, float]] = []
        self._first = True
        self.requests = b""

    def receive(self, data: bytes) -> bytes:
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


RplidarStandardFirmware = RplidarExpressFirmware = RplidarFirmware
