"""Grids and nav_msgs/OccupancyGrid. The one place that knows how a map travels."""

from __future__ import annotations

import io
import struct
from typing import Any

import genpy
import numpy as np
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapRequest, GetMapResponse

from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.grid import Grid
from ur_nodes.ros1.messages.geometry import pose_message, pose_of_message

_HEADER = struct.Struct("<4I")  # of an OccupancyGrid: sequence number, stamp, length of the frame's name
_REST = 76  # bytes from the frame's name to the number of cells


class GridMessage(OccupancyGrid):  # type: ignore[misc]  # generated without types
    """A nav_msgs/OccupancyGrid whose `data` is an int8 array (n), sent and received without a list of Python numbers.

    On the wire it is the same message. Data that was received is read-only and shares the memory of what arrived.
    """

    __slots__ = tuple(OccupancyGrid.__slots__)  # genpy reads the fields from it
    data: Any

    def serialize(self, buff: Any) -> None:
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
            self.data = np.frombuffer(str, np.int8, count, start + 4)
        except (struct.error, ValueError) as problem:
            raise genpy.DeserializationError(problem) from problem
        return self


class GridResponse(GetMapResponse):  # type: ignore[misc]  # generated without types
    """The answer of a `GridService`, with a GridMessage as `map`."""

    __slots__ = tuple(GetMapResponse.__slots__)

    def serialize(self, buff: Any) -> None:
        """Write the answer to a binary file."""
        self.map.serialize(buff)

    def deserialize(self, str: bytes) -> GridResponse:
        """Fill the answer from bytes. Raises genpy.DeserializationError: they end too early."""
        self.map = GridMessage().deserialize(str)
        return self


class GridService(GetMap):  # type: ignore[misc]  # generated without types
    """The service type nav_msgs/GetMap with GridMessages."""

    _request_class = GetMapRequest
    _response_class = GridResponse


def grid_of_message(message: OccupancyGrid) -> Grid:
    """The grid of a message. Raises UserError when size, data and resolution do not fit together."""
    info = message.info
    data: Any = message.data  # a tuple, an array of a GridMessage, or bytes
    if info.width * info.height != len(data):
        raise UserError(
            error(
                f"map of {info.width} x {info.height} cells with {len(data)} values, expected one value per cell",
                rule="bad-map",
            )
        )
    if not info.resolution > 0.0:
        raise UserError(error(f"map with resolution {info.resolution:g}, expected more than 0 m", rule="bad-map"))
    values = np.frombuffer(data, np.int8) if isinstance(data, bytes) else np.asarray(data, dtype=np.int8)
    # The message carries a float32 (0.0500000007...): take the shortest decimal of that value.
    resolution = float(np.format_float_positional(np.float32(info.resolution), unique=True))
    return Grid(values.reshape(info.height, info.width), resolution, pose_of_message(info.origin))


def grid_message(grid: Grid, frame: str, stamp: Any) -> GridMessage:
    """A message with the grid, whose values it shares; `stamp` is a rospy.Time."""
    message = GridMessage()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.info = metadata_message(grid, stamp)
    message.data = grid.values.ravel()
    return message


def metadata_message(grid: Grid, stamp: Any) -> MapMetaData:
    """Size, resolution and origin of the grid; `stamp` is when it was loaded."""
    return MapMetaData(
        map_load_time=stamp,
        resolution=grid.resolution,
        width=grid.width,
        height=grid.height,
        origin=pose_message(grid.origin),
    )
