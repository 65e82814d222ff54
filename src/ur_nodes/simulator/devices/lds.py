"""The lidars of a TurtleBot3: an LDS-01 as its packets are described, and an LDS-02 as ld08_driver reads it."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ur_nodes.simulator.devices.lidars import LdRobotFirmware, PacketHead
from ur_nodes.simulator.devices.plant import Plant

# ld08_driver, transform.cpp: where the eye of an LDS-02 is, and how it squints, in mm.
_AHEAD, _SLOPE, _ASIDE = 5.9, 0.11923, -20.14


class Lds01Firmware(PacketHead):
    """An LDS-01: 60 packets of 6 beams in a turn, after the command to start."""

    size = 6

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._beam = 1  # its first one is a degree from straight ahead
        self._scans = False

    def take(self, data: bytes) -> bytes:
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
    angles = np.arctan2(_SLOPE * distances + _ASIDE, distances + _AHEAD)
    return np.where(distances > 0.0, angles, 0.0)


def remove_eye(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Convert distances from the rotation axis to distances from the sensor, mm: the inverse of the host's formula."""
    square, linear = 1.0 + _SLOPE**2, _AHEAD + _SLOPE * _ASIDE
    rest = _AHEAD**2 + _ASIDE**2 - distances**2
    solved = (-linear + np.sqrt(np.maximum(0.0, linear**2 - square * rest))) / square
    return np.where(distances > 0.0, solved, 0.0)
