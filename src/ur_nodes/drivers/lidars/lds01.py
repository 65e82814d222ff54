"""The lidar LDS-01 of a TurtleBot3, an HLS-LFCD2: the driver hls_lfcd_lds_driver of Robotis, and its data sheet.

`b` starts it and `e` stops it. It sends packets of 42 bytes: FA, A0 and the number of the packet (0 to 59), tenths of a
turn a minute, for each of six beams a strength, a distance in mm and two bytes, and a checksum, twice. Which bytes it
sums up is not documented: here both have to be equal. Numbers are little-endian. Beams are a degree apart, clockwise;
the driver of Robotis puts the first one a degree clockwise of straight ahead.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.lidars.lidar import SendingLidar, join_frames, time_on_line
from ur_nodes.drivers.lidars.turning_head import PacketHead
from ur_nodes.drivers.readings import MeasuredBeams, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

_PACKETS, _BEAMS = 60, 6
_SAMPLE = [("strength", "<u2"), ("distance", "<u2"), ("reserved", "<u2")]
_PACKET = np.dtype([("start", "u1"), ("number", "u1"), ("speed", "<u2"), ("beams", _SAMPLE, _BEAMS), ("check", "<u2")])
_MOST = 15  # packets that are decoded together: less than a turn


class Lds01(SendingLidar):
    """See LidarProtocol."""

    name = "LDS-01 of a TurtleBot3"
    baud = 230400
    dtr = True

    def __init__(self) -> None:
        self._frames = FrameReader(b"\xfa", fixed(_PACKET.itemsize), _is_valid, _PACKET.itemsize)

    def handshake(self) -> bytes:
        """Start it."""
        return b"b"

    def shutdown(self) -> bytes:
        """Stop it."""
        return b"e"

    def receive(self, data: bytes) -> Iterator[Reading]:
        for joined in join_frames(self._frames.receive(data), _MOST):
            packets = np.frombuffer(joined, _PACKET)
            numbers = _BEAMS * (packets["number"].astype(np.float64) - 0xA0)[:, None] + np.arange(_BEAMS) + 1.0
            distances = packets["beams"]["distance"].ravel()
            speed = int(packets["speed"][-1])
            yield MeasuredBeams(
                np.radians(numbers.ravel() % 360.0),
                np.where(distances > 0, distances / 1000.0, np.inf),
                packets["beams"]["strength"].ravel().astype(np.float64),
                clockwise=True,
                turn_time=600.0 / speed if speed else 0.0,
                sending=time_on_line(_PACKET.itemsize, self.baud),
                frames=len(packets),
            )


def _is_valid(frame: bytes) -> bool:
    return 0xA0 <= frame[1] < 0xA0 + _PACKETS and frame[-1] == frame[-2]


# Stand-in: the packets as the data sheet describes them.


class Lds01Firmware(PacketHead):
    """An LDS-01: 60 packets of 6 beams in a turn, after the command to start."""

    size = 6

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._beam = 1  # its first one is a degree from straight ahead
        self._scans = False

    def receive(self, data: bytes) -> bytes:
        for byte in data:
            if byte in b"be":
                self._scans = byte == ord("b")
        return b""

    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        if not self._scans:
            return b""
        number = (points[0][0] - 1) % 360 // 6
        packet = struct.pack("<BBH", 0xFA, 0xA0 + number, round(self._lidar.rate * 600))
        packet += b"".join(struct.pack("<HHH", 900, round(mm) if mm < 65536 else 0, 0) for _, mm in points)
        return packet + bytes((255 - sum(packet) % 256,)) * 2
