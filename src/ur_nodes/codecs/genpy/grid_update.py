"""The message map_msgs/OccupancyGridUpdate, the cells of a grid that changed, without the package map_msgs."""

from __future__ import annotations

import io
import struct
from collections.abc import Sequence
from typing import BinaryIO, cast

import genpy
import numpy as np
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
