"""Grids and nav_msgs/OccupancyGrid. The one place that knows how a map travels."""

from __future__ import annotations

from typing import Any

import numpy as np
from nav_msgs.msg import MapMetaData, OccupancyGrid

from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.geometry import pose_message, pose_of_message


def grid_of_message(message: OccupancyGrid) -> Grid:
    """The grid of a message. Raises UserError when size, data and resolution do not fit together."""
    info = message.info
    data: Any = message.data  # rospy hands out a tuple, or bytes where numpy_msg is in use
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


def grid_message(grid: Grid, frame: str, stamp: Any) -> OccupancyGrid:
    """A message with the grid; `stamp` is a rospy.Time."""
    message = OccupancyGrid()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.info = metadata_message(grid, stamp)
    message.data = grid.values.ravel().tolist()
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
