"""Maps and what changes in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import SetMap

from ur.source.diagnostic import user_error
from ur_nodes.codecs import poses
from ur_nodes.codecs.codec import Codec, ServiceCodec, fill_header, frame_of, response_or_fail, value_or_fail
from ur_nodes.codecs.dialect import ROS_2, array_of, field_of, parts_of, stamp_of, time_of
from ur_nodes.codecs.geometry import checked_pose_of, fill_pose, pose_of_message
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.services import AskMap, Place, UseMap
from ur_nodes.ports.values import Map, MapInfo, MapUpdate, PoseEstimate, Result

if TYPE_CHECKING:
    from ur_nodes.codecs.genpy.grid import GridResponse

if ROS_2 and not TYPE_CHECKING:  # as in `dialect`
    from nav_msgs.msg import OccupancyGrid as GridMessage
    from nav_msgs.srv import GetMap as GridService

    try:
        from map_msgs.msg import OccupancyGridUpdate as GridUpdate
    except ImportError:
        from ur_nodes.codecs.bare import BareGridUpdate as GridUpdate
else:
    from ur_nodes.codecs.genpy.grid import GridMessage, GridService, GridUpdate

_MapRequest, _MapResponse = parts_of(GridService)
_UseRequest, _UseResponse = parts_of(SetMap)


def fill_map(message: OccupancyGrid, value: Map) -> None:
    """Write a nav_msgs/OccupancyGrid; the message shares the cells."""
    fill_header(message, value.stamp, value.frame)
    grid = value.grid
    _fill_info(message.info, MapInfo(value.stamp, grid.resolution, grid.width, grid.height, grid.origin))
    message.data = field_of(grid.values.ravel())


def map_of(message: OccupancyGrid) -> Map:
    """Read a nav_msgs/OccupancyGrid. Raises UserError: size, data and resolution do not fit together."""
    return Map(stamp_of(message.header.stamp), frame_of(message), grid_of_message(message))


def grid_of_message(message: OccupancyGrid) -> Grid:
    """The grid of a message. Raises UserError when size, data and resolution do not fit together."""
    info = message.info
    data = message.data
    if info.width * info.height != len(data):
        raise user_error(
            f"map of {info.width} x {info.height} cells with {len(data)} values, expected one value per cell",
            rule="bad-map",
        )
    values = array_of(data, np.int8)
    # The message carries a float32 (0.0500000007...): take the shortest decimal of that value.
    resolution = float(np.format_float_positional(np.float32(info.resolution), unique=True))
    return Grid(values.reshape(info.height, info.width), resolution, pose_of_message(info.origin))


def _fill_info(message: MapMetaData, value: MapInfo) -> None:
    message.map_load_time, message.resolution = time_of(value.stamp), value.resolution
    message.width, message.height = value.width, value.height
    fill_pose(message.origin, value.origin)


def _info_of(message: MapMetaData) -> MapInfo:
    stamp = stamp_of(message.map_load_time)
    return MapInfo(stamp, message.resolution, message.width, message.height, pose_of_message(message.origin))


def _fill_update(message: GridUpdate, value: MapUpdate) -> None:
    fill_header(message, value.stamp, value.frame)
    message.x, message.y = value.column, value.row
    message.height, message.width = value.values.shape
    message.data = field_of(value.values.ravel())


def _update_of(message: GridUpdate) -> MapUpdate:
    if message.width * message.height != len(message.data):
        raise ValueError(
            f"update of {message.width} x {message.height} cells with {len(message.data)} values, expected one per cell"
        )
    values = array_of(message.data, np.int8).reshape(message.height, message.width)
    return MapUpdate(stamp_of(message.header.stamp), frame_of(message), message.y, message.x, values)


def _map_response(result: Result) -> GridResponse:
    response = _MapResponse()
    response.map = GridMessage()
    fill_map(response.map, value_or_fail(result))
    return response


def _use_map_request(value: UseMap) -> SetMap.Request:
    request = _UseRequest()
    request.map = GridMessage()
    fill_map(request.map, value.map)
    start = PoseEstimate(value.stamp, value.frame, value.pose, value.covariance)
    poses.fill_estimate(request.initial_pose, start)
    return request


def _use_map_of(request: SetMap.Request) -> UseMap:
    start = poses.estimate_of(request.initial_pose)
    return UseMap(map_of(request.map), start.stamp, start.frame, start.pose, start.covariance)


def _use_map_response(result: Result) -> SetMap.Response:
    return response_or_fail(result, _UseResponse(success=True)) if result.text else _UseResponse(success=result.success)


def _place_request(value: Place) -> SetMap.Request:
    request = _UseRequest()
    request.map.header.frame_id, request.initial_pose.header.frame_id = value.name, value.frame
    fill_pose(request.initial_pose.pose.pose, value.pose)
    return request


def _place_of(request: SetMap.Request) -> Place:
    start = request.initial_pose
    return Place(str(request.map.header.frame_id), frame_of(start), checked_pose_of(start.pose.pose))


CODECS = {
    Map: Codec(GridMessage, fill_map, map_of),
    MapInfo: Codec(MapMetaData, _fill_info, _info_of),
    MapUpdate: Codec(GridUpdate, _fill_update, _update_of),
}

SERVICES = {
    AskMap: ServiceCodec(
        GridService,
        lambda _value: _MapRequest(),
        lambda _request: AskMap(),
        _map_response,
        lambda response: Result(success=True, value=map_of(response.map)),
    ),
    UseMap: ServiceCodec(
        SetMap, _use_map_request, _use_map_of, _use_map_response, lambda response: Result(bool(response.success))
    ),
    Place: ServiceCodec(
        SetMap,
        _place_request,
        _place_of,
        lambda result: response_or_fail(result, _UseResponse(success=True)),
        lambda response: Result(bool(response.success)),
    ),
}
