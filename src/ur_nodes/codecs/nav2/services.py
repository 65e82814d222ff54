"""Services that ROS 1 or a distribution of ROS 2 may lack: codecs for those whose messages are installed.

Numbers of results are those of nav2_msgs: 0 is success.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from ur_nodes.codecs import find_codec, maps
from ur_nodes.codecs.codec import KindServiceCodec, ServiceCodec
from ur_nodes.codecs.dialect import ServiceMessages, parts_of
from ur_nodes.ports.services import ClearCostmap, LoadMap, MapProblem
from ur_nodes.ports.values import Map, Result

_Message = Any  # of packages that are not installed where types are checked
_Service = ServiceMessages[_Message, _Message]
_Made = KindServiceCodec[_Message]

_LONGEST = 4096  # characters of a path
_FAILED = 255


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


def _clear_costmap(service: _Service) -> _Made:
    request_class, response_class = parts_of(service)
    return ServiceCodec(
        service,
        lambda _value: request_class(),
        lambda _request: ClearCostmap(),
        lambda _result: response_class(),
        lambda _response: Result(success=True),
    )


_MAKERS: dict[type, tuple[tuple[str, ...], Callable[[_Service], _Made]]] = {
    LoadMap: (("nav2_msgs.srv.LoadMap", "nav_msgs.srv.LoadMap"), _load_map),
    ClearCostmap: (("nav2_msgs.srv.ClearEntireCostmap",), _clear_costmap),
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
