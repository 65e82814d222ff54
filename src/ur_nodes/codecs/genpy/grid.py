"""Grids and their changes as arrays, without lists of Python numbers; OccupancyGridUpdate without its package."""

from __future__ import annotations

import io
import struct
from collections.abc import Sequence
from typing import BinaryIO, cast

import genpy
import numpy as np
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, GetMapRequest, GetMapResponse
from std_msgs.msg import Header

_BOX = struct.Struct("<2i3I")  # x, y, width, height, and the number of cells


class GridUpdate(genpy.Message):
    """New values `data`, int8 (height * width), of the cells from column `x` and row `y` on."""

    _md5sum = "b295be292b335c34718bd939deebe1c9"
    _type = "map_msgs/OccupancyGridUpdate"
    _has_header = True
    _full_text = (
        "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data\n"
        f"{'=' * 80}\nMSG: std_msgs/Header\n{Header._full_text}"  # noqa: SLF001 - where genpy keeps it
    )
    __slots__ = ("data", "header", "height", "width", "x", "y")
    _slot_types = ("int8[]", "std_msgs/Header", "uint32", "uint32", "int32", "int32")

    def __init__(self) -> None:
        self.header = Header()
        self.x = self.y = self.width = self.height = 0
        self.data = cast("Sequence[int]", np.empty(0, np.int8))

    def serialize(self, buff: BinaryIO) -> None:
        """Write the message to a binary file."""
        self.header.serialize(buff)
        cells = np.ascontiguousarray(self.data, np.int8).ravel()
        buff.write(_BOX.pack(self.x, self.y, self.width, self.height, len(cells)))
        buff.write(cells.data)

    def deserialize(self, str: bytes) -> GridUpdate:
        """Fill the message from bytes. Raises genpy.DeserializationError: they end too early."""
        try:
            self.header = Header().deserialize(str)
            head = io.BytesIO()
            self.header.serialize(head)
            start = head.tell()
            self.x, self.y, self.width, self.height, count = _BOX.unpack_from(str, start)
            self.data = cast("Sequence[int]", np.frombuffer(str, np.int8, count, start + _BOX.size))
        except (struct.error, ValueError) as problem:
            raise genpy.DeserializationError(problem) from problem
        return self


_HEADER = struct.Struct("<4I")  # of an OccupancyGrid: sequence number, stamp, length of the frame's name
_REST = 76  # bytes from the frame's name to the number of cells


class GridMessage(OccupancyGrid):
    """A nav_msgs/OccupancyGrid whose `data` is an int8 array (n), sent and received without a list of Python numbers.

    On the wire it is the same message. Data that was received is read-only and shares the memory of what arrived.
    """

    __slots__ = tuple(OccupancyGrid.__slots__)  # genpy reads the fields from it

    def serialize(self, buff: BinaryIO) -> None:
        """Write the message to a binary file."""
        values, self.data = self.data, ()
        head = io.BytesIO()
        try:
            super().serialize(head)
        finally:
            self.data = values
        cells = np.ascontiguousarray(values, dtype=np.int8).ravel()
        buff.write(head.getbuffer()[:-4])
        buff.write(struct.pack("<I", len(cells)))
        buff.write(cells.data)

    def deserialize(self, str: bytes) -> GridMessage:
        """Fill the message from bytes. Raises genpy.DeserializationError: they end too early."""
        try:
            start = _HEADER.size + _HEADER.unpack_from(str)[3] + _REST
            (count,) = struct.unpack_from("<I", str, start)
            super().deserialize(str[:start] + bytes(4))
            self.data = cast("Sequence[int]", np.frombuffer(str, np.int8, count, start + 4))
        except (struct.error, ValueError) as problem:
            raise genpy.DeserializationError(problem) from problem
        return self


class GridResponse(GetMapResponse):
    """The answer of a `GridService`, with a GridMessage as `map`."""

    __slots__ = tuple(GetMapResponse.__slots__)

    def serialize(self, buff: BinaryIO) -> None:
        """Write the answer to a binary file."""
        self.map.serialize(buff)

    def deserialize(self, str: bytes) -> GridResponse:
        """Fill the answer from bytes. Raises genpy.DeserializationError: they end too early."""
        self.map = GridMessage().deserialize(str)
        return self


class GridService(GetMap):
    """The service type nav_msgs/GetMap with GridMessages."""

    _request_class = GetMapRequest
    _response_class = GridResponse
