"""sensor_msgs/LaserScan and geometry_msgs/PoseArray, sent and received without lists of Python numbers or objects."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import BinaryIO, cast

import genpy
import numpy as np
from geometry_msgs.msg import PoseArray
from numpy.typing import NDArray
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header


class PosesMessage(PoseArray):
    """Many poses, written fast: `planar` is float64 (n, 3), m, m, rad; `poses` stays empty in what is sent."""

    __slots__ = ("planar",)
    planar: NDArray[np.float64]

    def serialize(self, buff: BinaryIO) -> None:
        """Write header, number and poses as http://wiki.ros.org/msg describes (little-endian)."""
        self.header.serialize(buff)
        buff.write(np.uint32(len(self.planar)).astype("<u4").tobytes())
        poses = np.zeros((len(self.planar), 7), dtype="<f8")
        poses[:, :2] = self.planar[:, :2]
        poses[:, 5] = np.sin(0.5 * self.planar[:, 2])
        poses[:, 6] = np.cos(0.5 * self.planar[:, 2])
        buff.write(poses.tobytes())


_HEADER = struct.Struct("<4I")  # sequence number, stamp, length of the frame's name
_FIGURES = struct.Struct("<7f")
_COUNT = struct.Struct("<I")


class ScanMessage(LaserScan):
    """A LaserScan whose `ranges` and `intensities` are float32 arrays; received ones share its memory."""

    __slots__ = tuple(LaserScan.__slots__)  # genpy reads the fields from it

    def serialize(self, buff: BinaryIO) -> None:
        """Write the message to a binary file."""
        self.header.serialize(buff)
        buff.write(
            _FIGURES.pack(
                self.angle_min,
                self.angle_max,
                self.angle_increment,
                self.time_increment,
                self.scan_time,
                self.range_min,
                self.range_max,
            )
        )
        for numbers in (self.ranges, self.intensities):
            array = np.ascontiguousarray(numbers, "<f4")
            buff.write(_COUNT.pack(len(array)))
            buff.write(array.data)

    def deserialize(self, str: bytes) -> ScanMessage:
        """Fill the message from bytes. Raises genpy.DeserializationError: they end too early."""
        try:
            self.header = Header().deserialize(str)
            start = _HEADER.size + _HEADER.unpack_from(str)[3]
            (
                self.angle_min,
                self.angle_max,
                self.angle_increment,
                self.time_increment,
                self.scan_time,
                self.range_min,
                self.range_max,
            ) = _FIGURES.unpack_from(str, start)
            self.ranges, start = _read_numbers(str, start + _FIGURES.size)
            self.intensities, _ = _read_numbers(str, start)
        except (struct.error, ValueError) as problem:
            raise genpy.DeserializationError(problem) from problem
        return self


def _read_numbers(data: bytes, start: int) -> tuple[Sequence[float], int]:
    """The numbers from a place on, and where they end."""
    (count,) = _COUNT.unpack_from(data, start)
    start += _COUNT.size
    return cast("Sequence[float]", np.frombuffer(data, np.float32, count, start)), start + 4 * count
