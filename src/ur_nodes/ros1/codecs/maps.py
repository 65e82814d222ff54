"""Maps and what changes in them."""

from __future__ import annotations

import math
from typing import Any

from nav_msgs.msg import MapMetaData

from ur_nodes.ports.values import Map, MapInfo, MapUpdate
from ur_nodes.ros1.codecs.codec import Codec, fill_header, frame_of, stamp_of, time_of
from ur_nodes.ros1.messages.geometry import fill_pose, pose_of_message
from ur_nodes.ros1.messages.grid import GridMessage, grid_of_message, metadata_message
from ur_nodes.ros1.messages.grid_update import GridUpdate

_FINEST = 1e-4  # m


def fill_map(message: Any, value: Map) -> None:
    """Write a nav_msgs/OccupancyGrid; the message shares the cells."""
    fill_header(message, value.stamp, value.frame)
    message.info = metadata_message(value.grid, time_of(value.stamp))
    message.data = value.grid.values.ravel()


def map_of(message: Any) -> Map:
    """Read a nav_msgs/OccupancyGrid. Raises UserError: size, data and resolution do not fit together."""
    grid = grid_of_message(message)
    if not _FINEST <= grid.resolution < math.inf:
        raise ValueError(f"map with resolution {grid.resolution:g}, expected {_FINEST:g} m or more")
    message.data = ()  # rospy keeps the last message, which is as large as the map
    return Map(stamp_of(message.header.stamp), frame_of(message), grid)


def _fill_info(message: Any, value: MapInfo) -> None:
    message.map_load_time, message.resolution = time_of(value.stamp), value.resolution
    message.width, message.height = value.width, value.height
    fill_pose(message.origin, value.origin)


def _info_of(message: Any) -> MapInfo:
    stamp = stamp_of(message.map_load_time)
    return MapInfo(stamp, message.resolution, message.width, message.height, pose_of_message(message.origin))


def _fill_update(message: Any, value: MapUpdate) -> None:
    fill_header(message, value.stamp, value.frame)
    message.x, message.y = value.column, value.row
    message.height, message.width = value.values.shape
    message.data = value.values.ravel()


def _update_of(message: Any) -> MapUpdate:
    if message.width * message.height != len(message.data):
        raise ValueError(
            f"update of {message.width} x {message.height} cells with {len(message.data)} values, expected one per cell"
        )
    values = message.data.reshape(message.height, message.width)
    return MapUpdate(stamp_of(message.header.stamp), frame_of(message), message.y, message.x, values)


CODECS = {
    Map: Codec(GridMessage, fill_map, map_of),
    MapInfo: Codec(MapMetaData, _fill_info, _info_of),
    MapUpdate: Codec(GridUpdate, _fill_update, _update_of),
}
