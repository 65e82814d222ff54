"""The lidar of a Neato XV-11, alone on a serial line: the packets of firmware 2.4 and later.

Source: the page "LIDAR Sensor" of the Neato XV-11 hacking wiki. It sends packets of 22 bytes by itself: FA, A0 and the
number of the packet (0 to 89), 64ths of a turn a minute, four times a distance and a strength, and a checksum. Numbers
are little-endian; the beams turn counter-clockwise, a degree apart.
"""

import struct
from collections.abc import Iterator, Sequence

import numpy as np

from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.lidars.lidar import SendingLidar, join_frames, time_on_line
from ur_nodes.drivers.lidars.turning_head import PacketHead
from ur_nodes.drivers.readings import MeasuredBeams, Reading

_SIZE = 22
_INVALID, _MILLIMETRES = 0x8000, 0x3FFF
_WORDS = struct.Struct("<10H")
_BEAM = [("distance", "<u2"), ("strength", "<u2")]
_PACKET = np.dtype([("start", "u1"), ("number", "u1"), ("speed", "<u2"), ("beams", _BEAM, 4), ("check", "<u2")])
_MOST = 20  # packets that are decoded together: less than a turn


class Xv11(SendingLidar):
    """See LidarProtocol."""

    name = "lidar of a Neato XV-11"
    baud = 115200
    dtr = True

    def __init__(self) -> None:
        self._frames = FrameReader(b"\xfa", fixed(_SIZE), _is_valid, _SIZE)

    def receive(self, data: bytes) -> Iterator[Reading]:
        for joined in join_frames(self._frames.receive(data), _MOST):
            packets = np.frombuffer(joined, _PACKET)
            distances, strengths = packets["beams"]["distance"].ravel(), packets["beams"]["strength"].ravel()
            phases = np.radians((4.0 * (packets["number"] - 0xA0)[:, None] + np.arange(4)).ravel())
            bad = ((distances & _INVALID) != 0) | ((distances & _MILLIMETRES) == 0)
            ranges = np.where(bad, np.inf, (distances & _MILLIMETRES) / 1000.0)
            speed = int(packets["speed"][-1])
            yield MeasuredBeams(
                phases,
                ranges,
                strengths.astype(np.float64),
                turn_time=60.0 * 64.0 / speed if speed else 0.0,
                sending=time_on_line(_SIZE, self.baud),
                frames=len(packets),
            )


def check(words: tuple[int, ...]) -> int:
    """The checksum of ten words: doubled sums, folded to 15 bits."""
    total = 0
    for word in words:
        total = (total << 1) + word
    return ((total & 0x7FFF) + (total >> 15)) & 0x7FFF


def _is_valid(frame: bytes) -> bool:
    return 0xA0 <= frame[1] < 0xFA and check(_WORDS.unpack_from(frame)) == int.from_bytes(frame[20:], "little")


# Stand-in: the packet of 22 bytes of the Neato hacking wiki.


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
