"""Messages of ROS 2 as CDR bytes (XCDR1): those whose packages may be missing, and those that come many times a second.

A class of this kind has `BARE`: package, name and RIHS01 hash of its type, by which the middleware finds the other end;
and the `DEFINITION` of its type, for recordings.
Numbers are aligned to their size, counted from after the head of four bytes.
"""

from __future__ import annotations

import math
import struct
from array import array
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped
from numpy.typing import NDArray
from std_msgs.msg import Header

from ur_nodes.codecs.geometry import matrix_of
from ur_nodes.geometry.pose import Pose2, yaw_of_quaternion
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.validation import UNIT_SLACK
from ur_nodes.ports.values import Odometry, Scan, StampedTwist, Time, Twist

_LITTLE_ENDIAN = b"\x00\x01\x00\x00"
ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}
"""The encodings that are read, by the first bytes of a message."""
_MOST = 10_000  # transforms of a message


class MessageWriter:
    """Writes the bytes of a message."""

    def __init__(self) -> None:
        self._data = bytearray()

    def add(self, form: str, *numbers: float) -> None:
        """Add numbers of one size, with a format of `struct`."""
        self._data += bytes(-len(self._data) % struct.calcsize(f"<{form[-1]}"))
        self._data += struct.pack(f"<{form}", *numbers)

    def add_text(self, text: str) -> None:
        """Add a string."""
        self.add_bytes(text.encode() + b"\0")

    def add_header(self, header: Header) -> None:
        """Add a std_msgs/Header."""
        self.add("iI", header.stamp.sec, header.stamp.nanosec)
        self.add_text(header.frame_id)

    def add_bytes(self, data: bytes) -> None:
        """Add a sequence of bytes."""
        self.add("I", len(data))
        self._data += data

    def finish(self) -> bytes:
        """Return the message."""
        return _LITTLE_ENDIAN + bytes(self._data)


class Reader:
    """Reads the bytes of a message in order. Raises ValueError if they are too short or no CDR."""

    def __init__(self, data: bytes) -> None:
        order = ORDERS.get(bytes(data[:2]))
        if order is None:
            raise ValueError(f"message in the encoding {bytes(data[:2]).hex()}, expected 0000 or 0001 (CDR)")
        self._order = order
        self._data = memoryview(data)[4:]
        self._place = 0

    def unpack(self, form: str) -> tuple[Any, ...]:
        """Take numbers of 4 or 8 bytes."""
        size = 8 if form[-1] == "d" else 4
        self._place += -self._place % size
        try:
            numbers = struct.unpack_from(self._order + form, self._data, self._place)
        except struct.error as problem:
            raise ValueError(f"message of {len(self._data)} bytes that ends too early: {problem}") from problem
        self._place += size * len(numbers)
        return numbers

    def unpack_bytes(self, count: int | None = None) -> bytes:
        """Take a sequence of bytes, of `count` where that was read before."""
        count = self.unpack("I")[0] if count is None else count
        if count > len(self._data) - self._place:
            raise ValueError(f"sequence of {count} bytes, {len(self._data) - self._place} are left")
        self._place += count
        return bytes(self._data[self._place - count : self._place])

    def unpack_floats(self) -> NDArray[np.float32]:
        """Take a sequence of numbers of 32 bits."""
        data = self.unpack_bytes(4 * self.unpack("I")[0])
        return np.frombuffer(data, f"{self._order}f4").astype(np.float32, copy=False)

    def unpack_text(self, count: int | None = None) -> str:
        """Take a string, as `unpack_bytes`."""
        return self.unpack_bytes(count).rstrip(b"\0").decode(errors="replace")

    def unpack_head(self) -> tuple[int, str]:
        """Take a std_msgs/Header as stamp (ns) and frame."""
        seconds, rest, length = self.unpack("iII")
        return seconds * SECOND + rest, self.unpack_text(length)

    def unpack_header(self) -> Header:
        """Take a std_msgs/Header."""
        header = Header()
        header.stamp.sec, header.stamp.nanosec, length = self.unpack("iII")
        header.frame_id = self.unpack_text(length)
        return header


class BareGridUpdate:
    """map_msgs/msg/OccupancyGridUpdate: new cells `data`, int8, from column `x` and row `y` on."""

    BARE = (*("map_msgs", "OccupancyGridUpdate"), "c4095b0be2e4363f8978a1570e0293ee093436f1e1c61d99b48502ac317025e8")
    DEFINITION = "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data\n"

    def __init__(self) -> None:
        self.header = Header()
        self.x = self.y = self.width = self.height = 0
        self.data = array("b")

    def write(self) -> bytes:
        """The message as bytes."""
        writer = MessageWriter()
        writer.add_header(self.header)
        writer.add("2i", self.x, self.y)
        writer.add("2I", self.width, self.height)
        writer.add_bytes(self.data.tobytes())
        return writer.finish()

    @classmethod
    def read(cls, data: bytes) -> BareGridUpdate:
        """The message that bytes are. Raises ValueError."""
        reader, made = Reader(data), cls()
        made.header = reader.unpack_header()
        (made.x, made.y), (made.width, made.height) = reader.unpack("2i"), reader.unpack("2I")
        made.data = array("b", reader.unpack_bytes())
        return made


class BareTransforms:
    """tf2_msgs/msg/TFMessage."""

    BARE = ("tf2_msgs", "TFMessage", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087")
    DEFINITION = "geometry_msgs/TransformStamped[] transforms\n"

    def __init__(self) -> None:
        self.transforms: list[TransformStamped] = []

    def write(self) -> bytes:
        """The message as bytes."""
        writer = MessageWriter()
        writer.add("I", len(self.transforms))
        for each in self.transforms:
            writer.add_header(each.header)
            writer.add_text(each.child_frame_id)
            place, turn = each.transform.translation, each.transform.rotation
            writer.add("7d", place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w)
        return writer.finish()

    @classmethod
    def read(cls, data: bytes) -> BareTransforms:
        """The message that bytes are. Raises ValueError."""
        reader, made = Reader(data), cls()
        (count,) = reader.unpack("I")
        if count > _MOST:
            raise ValueError(f"TFMessage with {count} transforms, expected at most {_MOST}")
        for _ in range(count):
            each = TransformStamped(header=reader.unpack_header(), child_frame_id=reader.unpack_text())
            place, turn = each.transform.translation, each.transform.rotation
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = reader.unpack("7d")
            made.transforms.append(each)
        return made


def _twist_of(forward: float, left: float, up: float, roll: float, pitch: float, turn: float) -> Twist:
    return Twist(forward, turn, left, up, roll, pitch)


def _read_odometry(reader: Reader) -> Odometry:
    (stamp, frame), child = reader.unpack_head(), reader.unpack_text()
    numbers = reader.unpack("85d")
    turn = numbers[3:7]
    yaw = yaw_of_quaternion(*turn) if abs(math.hypot(*turn) - 1.0) <= UNIT_SLACK else math.nan
    pose, twist = Pose2(numbers[0], numbers[1], yaw), _twist_of(*numbers[43:49])
    covariances = _matrix_of(numbers[7:43]), _matrix_of(numbers[49:])
    return Odometry(stamp, frame.lstrip("/"), child.lstrip("/"), pose, twist, *covariances)


_matrix_of = lru_cache(maxsize=16)(matrix_of)  # covariances seldom change, and no node changes one


def _read_scan(reader: Reader) -> Scan:
    stamp, frame = reader.unpack_head()
    first, last, step, beam, turn, nearest, furthest = reader.unpack("7f")
    ranges, intensities = reader.unpack_floats(), reader.unpack_floats()
    return Scan(stamp, frame.lstrip("/"), first, step, nearest, furthest, ranges, intensities, turn, last, beam)


READERS: dict[type, Callable[[Reader], object]] = {
    Odometry: _read_odometry,
    Scan: _read_scan,
    StampedTwist: lambda reader: StampedTwist(*reader.unpack_head(), _twist_of(*reader.unpack("6d"))),
    Twist: lambda reader: _twist_of(*reader.unpack("6d")),
}
"""Functions that read values of a kind, and raise ValueError. rclpy would make an object for each part of a message."""

WRITERS: dict[type, Callable[..., bytes]] = {
    Time: lambda time: _LITTLE_ENDIAN + struct.pack("<iI", *divmod(time.stamp, SECOND)),
    Twist: lambda to: _LITTLE_ENDIAN + struct.pack("<6d", to.forward, to.left, to.up, to.roll, to.pitch, to.turn),
}
"""Functions that write values of a kind."""
