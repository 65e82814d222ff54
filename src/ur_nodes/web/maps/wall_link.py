"""Walls of the map in use, for pages: the map server draws, erases and restores them on request."""

from collections.abc import Mapping
from dataclasses import asdict

from ur.maps.names import is_map_name
from ur.web.wire.map_requests import DrawWalls, RestoreWalls
from ur_nodes.ports.node import Node
from ur_nodes.web.maps.request_topic import Done, RequestTopic


class WallLink:
    """Follows the map server, and passes changes on."""

    def __init__(self, node: Node) -> None:
        self._topic = RequestTopic(node, "wall", _read, ("", False))

    def describe(self) -> Mapping[str, object]:
        """Describe for a page: `name` of the map whose walls can be changed; or "" and the reason `why` they cannot."""
        if not self._topic.served():
            return {"name": "", "restorable": False, "why": "no server"}
        name, restorable = self._topic.state
        return {"name": name, "restorable": restorable, "why": "" if name else "file"}

    def change(self, request: DrawWalls | RestoreWalls, done: Done) -> bool:
        """Request a change; `done` is called with the error, or ''. Return False if no map server has walls."""
        value: dict[str, object] = {"do": "restore", "map": request.map}
        if isinstance(request, DrawWalls):
            value = {"do": "draw", "map": request.map, "strokes": [asdict(each) for each in request.strokes]}
        return self._topic.ask(value, done)


def _read(found: Mapping[str, object]) -> tuple[str, bool]:
    """Read the name of the stored map, and whether it can be restored."""
    name = str(found["name"])
    return name if is_map_name(name) else "", found["restorable"] is True
