"""Requests of services and their answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlan, SetMap
from std_srvs.srv import Empty, SetBool
from std_srvs.srv import Trigger as TriggerService

from ur_nodes.codecs import maps, places
from ur_nodes.codecs.codec import ServiceCodec, frame_of
from ur_nodes.codecs.dialect import GridMessage, GridService, ServiceFailureError, parts_of
from ur_nodes.codecs.geometry import fill_pose, pose_of_message
from ur_nodes.ports.services import AskMap, AskPath, Place, Silent, Switch, Trigger, UseMap
from ur_nodes.ports.values import PoseEstimate, Result

if TYPE_CHECKING:
    from ur_nodes.codecs.genpy.grid import GridResponse

Response = TypeVar("Response")

_MapRequest, _MapResponse = parts_of(GridService)
_PlanRequest, _PlanResponse = parts_of(GetPlan)
_UseRequest, _UseResponse = parts_of(SetMap)
_TriggerRequest, _TriggerResponse = parts_of(TriggerService)
_SwitchRequest, _SwitchResponse = parts_of(SetBool)
_SilentRequest, _SilentResponse = parts_of(Empty)


def _done(result: Result) -> Result:
    """Raise the failure of a service whose answer has no field for it."""
    if not result.success:
        raise ServiceFailureError(result.text)
    return result


def _fail_or(result: Result, response: Response) -> Response:
    _done(result)
    return response


def _reported(response: TriggerService.Response | SetBool.Response) -> Result:
    return Result(bool(response.success), str(response.message))


def _map_response(result: Result) -> GridResponse:
    response = _MapResponse()
    response.map = GridMessage()
    maps.fill_map(response.map, _done(result).value)  # type: ignore[arg-type]  # AskMap is answered with a Map
    return response


def _use_map_request(value: UseMap) -> SetMap.Request:
    request = _UseRequest()
    request.map = GridMessage()
    maps.fill_map(request.map, value.map)
    start = PoseEstimate(value.stamp, value.frame, value.pose, value.covariance)
    places.fill_estimate(request.initial_pose, start)
    return request


def _use_map_of(request: SetMap.Request) -> UseMap:
    start = places.estimate_of(request.initial_pose)
    return UseMap(maps.map_of(request.map), start.stamp, start.frame, start.pose, start.covariance)


def _place_request(value: Place) -> SetMap.Request:
    request = _UseRequest()
    request.map.header.frame_id, request.initial_pose.header.frame_id = value.name, value.frame
    fill_pose(request.initial_pose.pose.pose, value.pose)
    return request


def _place_of(request: SetMap.Request) -> Place:
    start = request.initial_pose
    return Place(str(request.map.header.frame_id), frame_of(start), pose_of_message(start.pose.pose))


def _ask_path_request(value: AskPath) -> GetPlan.Request:
    request = _PlanRequest(start=PoseStamped(), goal=PoseStamped(), tolerance=value.tolerance)
    places.fill_placed(request.start, value.start)
    places.fill_placed(request.goal, value.goal)
    return request


def _path_response(result: Result) -> GetPlan.Response:
    response = _PlanResponse()
    places.fill_path(response.plan, _done(result).value)  # type: ignore[arg-type]  # AskPath is answered with a Path
    return response


SERVICES = {
    Trigger: ServiceCodec(
        TriggerService,
        lambda _value: _TriggerRequest(),
        lambda _request: Trigger(),
        lambda result: _TriggerResponse(success=result.success, message=result.text),
        _reported,
    ),
    Silent: ServiceCodec(
        Empty,
        lambda _value: _SilentRequest(),
        lambda _request: Silent(),
        lambda result: _fail_or(result, _SilentResponse()),
        lambda _response: Result(success=True),
    ),
    Switch: ServiceCodec(
        SetBool,
        lambda value: _SwitchRequest(data=value.on),
        lambda request: Switch(bool(request.data)),
        lambda result: _SwitchResponse(success=result.success, message=result.text),
        _reported,
    ),
    AskMap: ServiceCodec(
        GridService,
        lambda _value: _MapRequest(),
        lambda _request: AskMap(),
        _map_response,
        lambda response: Result(success=True, value=maps.map_of(response.map)),
    ),
    UseMap: ServiceCodec(
        SetMap,
        _use_map_request,
        _use_map_of,
        lambda result: (
            _fail_or(result, _UseResponse(success=True)) if result.text else _UseResponse(success=result.success)
        ),
        lambda response: Result(bool(response.success)),
    ),
    Place: ServiceCodec(
        SetMap,
        _place_request,
        _place_of,
        lambda result: _fail_or(result, _UseResponse(success=True)),
        lambda response: Result(bool(response.success)),
    ),
    AskPath: ServiceCodec(
        GetPlan,
        _ask_path_request,
        lambda request: AskPath(
            places.target_of(request.start), places.target_of(request.goal), float(request.tolerance)
        ),
        _path_response,
        lambda response: Result(success=True, value=places.path_of(response.plan)),
    ),
}
