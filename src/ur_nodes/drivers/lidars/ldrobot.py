"""LDROBOT LD06 and LD19: "LD06 Development Manual" and "LD19 Development Manual"; LDS-02 of a TurtleBot3: ld08_driver.

It sends frames of 47 bytes by itself: 54, 2C, the speed in degrees a second, the angle of the first of 12 points, for
each point a distance in mm and its confidence, the angle of the last one, a time in ms, and a CRC of 8 bits. Numbers
are little-endian, angles hundredths of a degree, clockwise. The eye of an LDS-02 is beside the axis, and squints: each
beam is corrected by its distance, as transform.cpp of Robotis' ld08_driver does.
"""

import struct
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.lidars.lidar import SendingLidar, join_frames, time_on_line
from ur_nodes.drivers.lidars.turning_head import PacketHead
from ur_nodes.drivers.readings import MeasuredBeams, Reading

_Floats = NDArray[np.float64]
POINTS = 12
_SIZE = 47
_POLYNOMIAL = 0x4D
_POINT = [("distance", "<u2"), ("confidence", "u1")]
_FRAME = np.dtype(
    [
        *(("start", "<u2"), ("speed", "<u2"), ("first", "<u2"), ("points", _POINT, POINTS)),
        *(("last", "<u2"), ("time", "<u2"), ("check", "u1")),
    ]
)
_AHEAD, _SLOPE, _ASIDE = 5.9, 0.11923, -20.14  # of the eye of an LDS-02, in mm
_MOST = 7  # frames that are decoded together: less than a turn


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

    def receive(self, data: bytes) -> Iterator[Reading]:
        for joined in join_frames(self._frames.receive(data), _MOST):
            frames = np.frombuffer(joined, _FRAME)
            first, last = (frames[name].astype(np.float64)[:, None] for name in ("first", "last"))
            degrees = (first + (last - first) % 36000.0 * np.arange(POINTS) / (POINTS - 1)).ravel() % 36000.0 / 100.0
            distances, confidences = (frames["points"][name].ravel() for name in ("distance", "confidence"))
            degrees, millimetres = self._correct(degrees, distances.astype(np.float64))
            speed = int(frames["speed"][-1])
            yield MeasuredBeams(
                np.radians(degrees),
                np.where(distances > 0, millimetres / 1000.0, np.inf),
                confidences.astype(np.float64),
                clockwise=True,
                turn_time=360.0 / speed if speed else 0.0,
                sending=time_on_line(_SIZE, self.baud),
                frames=len(frames),
            )

    def _correct(self, degrees: _Floats, millimetres: _Floats) -> tuple[_Floats, _Floats]:
        """Return the angles and distances from the axis, where the eye is."""
        return degrees, millimetres


class Lds02(LdRobot):
    """See LidarProtocol."""

    name = "LDS-02 of a TurtleBot3"
    baud = 115200

    def _correct(self, degrees: _Floats, millimetres: _Floats) -> tuple[_Floats, _Floats]:
        ahead, aside = millimetres + _AHEAD, millimetres * _SLOPE + _ASIDE
        turned = np.where(millimetres > 0.0, np.degrees(np.arctan2(aside, ahead)), 0.0)
        return (degrees - turned) % 360.0, np.hypot(ahead, aside)


def check(data: bytes) -> int:
    """The CRC of 8 bits, polynomial 4D, which begins with 0."""
    value = 0
    for byte in data:
        value = _TABLE[value ^ byte]
    return value


# Stand-in: the tables of LDROBOT's manual, and an LDS-02 as ld08_driver reads it.

# ld08_driver, transform.cpp: where the eye of an LDS-02 is, and how it squints, in mm.
_EYE_AHEAD, _EYE_SLOPE, _EYE_ASIDE = 5.9, 0.11923, -20.14


class LdRobotFirmware(PacketHead):
    """An LD06."""

    size = 12

    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        head = struct.pack("<BBHH", 0x54, 0x2C, round(self._lidar.rate * 360), points[0][0] % 360 * 100)
        body = b"".join(struct.pack("<HB", round(mm), 200) for _, mm in points)
        frame = head + body + struct.pack("<HH", points[-1][0] % 360 * 100, round(self._plant.time * 1000) % 30000)
        return frame + bytes((_crc8(frame),))


def _crc8(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value * 2) ^ (0x14D if value & 0x80 else 0)
    return value


class Lds02Firmware(LdRobotFirmware):
    """An LDS-02: the frames of an LD06, with the distances from an eye beside the axis."""

    def measure(self, beams: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """See TurningHead. The eye sees what is where the host puts it."""
        raw = np.radians(beams % 360)
        seen = self.look(raw)
        for _ in range(3):
            seen = self.look(raw - squint(remove_eye(seen)))
        return remove_eye(seen)


def squint(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return by which angles (rad, counter-clockwise) the host turns beams of these distances from the sensor, mm."""
    angles = np.arctan2(_EYE_SLOPE * distances + _EYE_ASIDE, distances + _EYE_AHEAD)
    return np.where(distances > 0.0, angles, 0.0)


def remove_eye(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Convert distances from the rotation axis to distances from the sensor, mm: the inverse of the host's formula."""
    square, linear = 1.0 + _EYE_SLOPE**2, _EYE_AHEAD + _EYE_SLOPE * _EYE_ASIDE
    rest = _EYE_AHEAD**2 + _EYE_ASIDE**2 - distances**2
    solved = (-linear + np.sqrt(np.maximum(0.0, linear**2 - square * rest))) / square
    return np.where(distances > 0.0, solved, 0.0)
