"""Requests of pages about the map: the owners of places, zones and walls change them, and the page gets the result."""

from collections.abc import Callable, Mapping

from ur.web.wire.map_requests import (
    DeleteZone,
    DrawWalls,
    ForgetPlace,
    MapRequest,
    NamePlace,
    PutZone,
    RestoreWalls,
    SaveMap,
)
from ur_nodes.web.maps.map_link import MapLink
from ur_nodes.web.maps.map_server_link import ZoneLink
from ur_nodes.web.maps.place_file import PlaceFile

Reply = Callable[[str, Mapping[str, object]], None]
"""Sends an answer to a page, by its client id."""

_WHAT: Mapping[type, str] = {
    PutZone: "put_zone",
    DeleteZone: "delete_zone",
    DrawWalls: "draw_walls",
    RestoreWalls: "restore_walls",
}


class MapChanges:
    """Passes requests about the map to their owners; `reply` sends each answer, possibly later."""

    def __init__(self, places: PlaceFile, zones: ZoneLink, maps: MapLink, reply: Reply) -> None:
        self._places, self._zones, self._maps, self._reply = places, zones, maps, reply

    def apply(self, client: str, request: MapRequest) -> None:
        """Pass on a request of a page that may drive."""
        if isinstance(request, NamePlace | ForgetPlace):
            self._places.change(request, lambda answer: self._reply(client, answer))
        elif isinstance(request, SaveMap):
            self._save_map(client)
        else:
            what = _WHAT[type(request)]

            def answer(problem: str) -> None:
                result = {"t": "refused", "why": problem} if problem else {"t": "done"}
                self._reply(client, {**result, "what": what})

            if isinstance(request, DrawWalls | RestoreWalls):
                if not self._maps.walls.change(request, answer):
                    answer("no walls")
            elif not self._zones.change(request, answer):
                answer("no zones")

    def _save_map(self, client: str) -> None:
        def answer(name: str, problem: str) -> None:
            what = {"t": "done", "name": name} if name else {"t": "refused", "why": problem}
            self._reply(client, {**what, "what": "save_map"})

        self._maps.save(answer)
