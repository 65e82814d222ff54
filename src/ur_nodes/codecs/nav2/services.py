"""Services that ROS 1 or a distribution of ROS 2 may lack: codecs for those whose messages are installed.

Numbers of results are those of nav2_msgs and slam_toolbox: 0 is success.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from ur_nodes.codecs import find_codec, maps, poses
from ur_nodes.codecs.codec import KindServiceCodec, ServiceCodec
from ur_nodes.codecs.dialect import ServiceMessages, parts_of
from ur_nodes.ports.services import (
    ClearCostmap,
    LoadMap,
    MapProblem,
    Pause,
    SaveOwnMap,
    SaveTopicMap,
    SerializeMap,
    SetInitialPose,
)
from ur_nodes.ports.values import Map, Result

_Message = Any  # of packages that are not installed where types are checked
_Service = ServiceMessages[_Message, _Message]
_Made = KindServiceCodec[_Message]

_LONGEST = 4096  # characters of a path
_FAILED = 255
_FORMATS = ("", "pgm")
_MODES = ("", "trinary")
_OCCUPIED, _FREE = 0.65, 0.25  # where a request has 0


def _text(given: object) -> str:
    """Return the text of a request. Raises ValueError if it is too long."""
    text = str(given)
    if len(text) > _LONGEST:
        raise ValueError(f"text of {len(text)} characters, expected at most {_LONGEST}")
    return text


def _load_map(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)

    def respond(result: Result) -> _Message:
        response = response_class()
        response.map = find_codec(Map).message_class()
        if result.success:
            maps.fill_map(response.map, result.value)  # type: ignore[arg-type]  # LoadMap is answered with a Map
        else:
            response.result = int(result.value) if isinstance(result.value, MapProblem) else _FAILED
        return response

    return ServiceCodec(
        service,
        lambda value: request_class(map_url=value.file),
        lambda request: LoadMap(_text(request.map_url)),
        respond,
        lambda response: (
            Result(success=False, value=response.result)
            if response.result
            else Result(success=True, value=maps.map_of(response.map))
        ),
    )


def _save_map(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)

    def fill(value: SaveTopicMap) -> _Message:
        request = request_class(map_topic=value.topic, map_url=value.name)
        request.occupied_thresh, request.free_thresh = value.occupied / 100, value.free / 100
        return request

    def read(request: _Message) -> SaveTopicMap:
        if request.image_format not in _FORMATS or request.map_mode not in _MODES:
            raise ValueError(f"{_text(request.image_format)} {_text(request.map_mode)}, expected pgm trinary")
        occupied, free = request.occupied_thresh or _OCCUPIED, request.free_thresh or _FREE
        if not 0.0 <= free < occupied <= 1.0:
            raise ValueError(
                f"free_thresh {free:g} and occupied_thresh {occupied:g}, expected 0 <= free < occupied <= 1"
            )
        return SaveTopicMap(_text(request.map_url), _text(request.map_topic), round(occupied * 100), round(free * 100))

    return ServiceCodec(
        service,
        fill,
        read,
        lambda result: response_class(result=result.success),
        lambda response: Result(bool(response.result)),
    )


def _save_own_map(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)

    def fill(value: SaveOwnMap) -> _Message:
        request = request_class()
        request.name.data = value.name
        return request

    return ServiceCodec(
        service,
        fill,
        lambda request: SaveOwnMap(_text(request.name.data)),
        lambda result: response_class(result=0 if result.success else _FAILED),
        lambda response: Result(response.result == 0),
    )


def _store_map(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)
    return ServiceCodec(
        service,
        lambda value: request_class(filename=value.name),
        lambda request: SerializeMap(_text(request.filename)),
        lambda result: response_class(result=0 if result.success else _FAILED),
        lambda response: Result(response.result == 0),
    )


def _plain(kind: type, carries_success: bool) -> Callable[[_Service], _Made]:
    """A service without anything in its request; its answer has `status`, or nothing."""

    def make(service: _Service) -> _Made:
        request_class, response_class = parts_of(service)
        return ServiceCodec(
            service,
            lambda _value: request_class(),
            lambda _request: kind(),
            lambda result: response_class(status=result.success) if carries_success else response_class(),
            lambda response: Result(bool(response.status) if carries_success else True),
        )

    return make


def _set_pose(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)

    def fill(value: SetInitialPose) -> _Message:
        request = request_class()
        poses.fill_estimate(request.pose, value.estimate)
        return request

    return ServiceCodec(
        service,
        fill,
        lambda request: SetInitialPose(poses.estimate_of(request.pose)),
        lambda _result: response_class(),
        lambda _response: Result(success=True),
    )


_MAKERS: dict[type, tuple[tuple[str, ...], Callable[[_Service], _Made]]] = {
    LoadMap: (("nav2_msgs.srv.LoadMap", "nav_msgs.srv.LoadMap"), _load_map),
    SaveTopicMap: (("nav2_msgs.srv.SaveMap",), _save_map),
    SaveOwnMap: (("slam_toolbox.srv.SaveMap",), _save_own_map),
    SerializeMap: (("slam_toolbox.srv.SerializePoseGraph",), _store_map),
    ClearCostmap: (("nav2_msgs.srv.ClearEntireCostmap",), _plain(ClearCostmap, carries_success=False)),
    SetInitialPose: (("nav2_msgs.srv.SetInitialPose",), _set_pose),
    Pause: (("slam_toolbox.srv.Pause",), _plain(Pause, carries_success=True)),
}


def _find(names: tuple[str, ...]) -> _Service | None:
    """Return the first of these types that is installed."""
    for name in names:
        module, _, own = name.rpartition(".")
        try:
            found: _Service = getattr(import_module(module), own)
        except (ImportError, AttributeError):
            continue
        return found
    return None


SERVICES = {kind: make(found) for kind, (names, make) in _MAKERS.items() if (found := _find(names)) is not None}
