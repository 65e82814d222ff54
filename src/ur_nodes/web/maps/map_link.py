"""The stored map of the robot's programs, for pages: its name, and the service that saves a map during mapping."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from ur.maps.names import is_map_name
from ur.source.printable import printable
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
from ur_nodes.client.saving import read_saved
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.web.maps.map_server_link import WallLink, ZoneLink
from ur_nodes.web.maps.place_file import PlaceFile

_SERVICE_NAME = re.compile(r"/?[A-Za-z][\w/]{0,200}", re.ASCII)
_KEEPER = "keyboard_navigate"
_SERVER = "static_map"  # the service of the map server, which runs where the keeper is left out, too
_SAVERS = (_KEEPER, "teleop_twist_keyboard", "explore")  # nodes with the parameter `save_service`
_PERIOD = 2.0  # s
_SAVING = 60.0  # s that a map may take to be saved
_LANE = "map"

Done = Callable[[str, str], None]


class MapLink:
    """Follows the parameters of programs."""

    def __init__(self, node: Node) -> None:
        self.walls = WallLink(node)
        self.on_graph: Callable[[Graph], None] = lambda _: None
        """Called with each graph that is read."""
        self._node = node
        self._name, self._service = "", ""  # of the map, and of the service that saves it
        self._asking = self._saving = False
        node.after(0.0, self._ask, steady=True)
        node.every(_PERIOD, self._ask, steady=True)

    def describe(self) -> Mapping[str, object]:
        """Describe for a page: `name` of the stored map in use ("" for none), `saves` during mapping, and `walls`."""
        made = {"name": "", "restorable": False, "why": "made"}
        return {
            "name": self._name,
            "saves": self._service != "",
            "walls": made if self._service else self.walls.describe(),
        }

    def save(self, done: Done) -> None:
        """Save the map that is being made; `done` is called with its name, or with "" and the error."""
        if not self._service:
            done("", "no map")
        elif self._saving:
            done("", "busy")
        else:
            self._saving = True
            self._node.call(self._service, Trigger(), partial(self._on_saved, done), _SAVING)

    def _on_saved(self, done: Done, result: Result) -> None:
        self._saving = False
        name, problem = read_saved(result)
        done(name, "" if name else printable(problem)[:300] or "the service gives no reason")

    def _ask(self) -> None:
        if not self._asking:
            self._asking = True
            self._node.read_graph(self._on_graph)

    def _on_graph(self, graph: Graph | None) -> None:
        if graph is None:  # a master that does not answer has changed nothing
            self._asking = False
        else:
            self.on_graph(graph)
            self._node.work(lambda: self._read_names(graph), self._on_names, _LANE)

    def _read_names(self, graph: Graph) -> tuple[str, str] | None:
        """Return the name of the map and the service that saves it; None while the parameters cannot be read."""
        parameters, resolve = self._node.parameters, self._node.resolve
        try:
            service = choose_service([parameters.of(each).any("save_service", "") for each in _SAVERS])
            service = resolve(service) if service else ""
            if service not in graph.services:  # parameters stay when their node has ended
                service = ""
            name = choose_name(parameters.of(_KEEPER).any("map_name", ""), made=service != "")
        except Exception as problem:
            self._node.log.debug(f"map link: {problem}")
            return None
        return name if resolve(_SERVER) in graph.services else "", service

    def _on_names(self, found: tuple[str, str] | None) -> None:
        self._asking = False
        if found is not None:
            self._name, self._service = found


def choose_service(values: Sequence[object]) -> str:
    """Return the first of these parameter values that is the name of a service; "" if none is."""
    names = (each for each in values if isinstance(each, str) and _SERVICE_NAME.fullmatch(each))
    return next(names, "")


def choose_name(value: object, *, made: bool) -> str:
    """Return the name of the stored map that a program navigates on; "" for a file or a map that is being `made`."""
    return value if isinstance(value, str) and is_map_name(value) and not made else ""


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
