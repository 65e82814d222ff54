"""Zones and walls of the map in use, for pages: the map server changes and stores them on request."""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any, Generic, TypeVar

from ur.maps.names import is_map_name
from ur.maps.record import MOST_ZONES, Zone, read_zone
from ur.source.foreign.json_values import read_json, write_json
from ur.source.printable import printable
from ur.web.wire.map_requests import DeleteZone, DrawWalls, PutZone, RestoreWalls
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

Done = Callable[[str], None]
"""Called with the error, or ''."""

State = TypeVar("State")

_LONGEST = 2_000_000  # characters of a state
_MOST_WAITING = 100


class RequestTopic(Generic[State]):
    """Publishes requests as JSON with an `id` on the topic NAME_request; `state` is the newest on the topic NAMEs."""

    def __init__(self, node: Node, name: str, read: Callable[[Mapping[str, object]], State], first: State) -> None:
        """`read` converts JSON to a state; it raises ValueError, TypeError or KeyError if it is malformed."""
        self.state = first
        self._node, self._read = node, read
        self._numbers = itertools.count(1)
        self._waiting: dict[str, Done] = {}
        self._requests = node.publish(f"{name}_request", str, Quality.EVERY)
        self._states = node.subscribe(f"{name}s", str, self._on_text, Quality.LATCHED)

    def served(self) -> bool:
        """Return whether a node takes requests."""
        return self._requests.subscribers() > 0

    def ask(self, request: Mapping[str, object], done: Done) -> bool:
        """Send a request; return False without calling `done` if no node takes requests."""
        if not self.served():
            return False
        key = f"{self._node.name}-{next(self._numbers)}"
        self._waiting[key] = done
        while len(self._waiting) > _MOST_WAITING:
            del self._waiting[next(iter(self._waiting))]
        self._requests.send(write_json({"id": key, **request}))
        return True

    def _on_text(self, text: str) -> None:
        """Take a state, and the answer in it if that is new."""
        try:
            found = read_json(text, dict, _LONGEST)
            state, answer = self._read(found), found["answer"]
            id, problem = ("", "") if answer is None else (str(answer["id"]), printable(str(answer["problem"]))[:300])
        except (ValueError, TypeError, KeyError):
            self._node.log.warn(f"{self._states.topic}: not what a map server publishes; it is ignored", every=10.0)
            return
        self.state = state
        done = self._waiting.pop(id, None)
        if done is not None:
            done(problem)


class WallLink:
    """Follows the map server, and passes changes on."""

    def __init__(self, node: Node) -> None:
        self._topic = RequestTopic(node, "wall", _read_walls, ("", False))

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


def _read_walls(found: Mapping[str, object]) -> tuple[str, bool]:
    """Read the name of the stored map, and whether it can be restored."""
    name = str(found["name"])
    return name if is_map_name(name) else "", found["restorable"] is True


_Zones = tuple[tuple[Zone, ...], str]


class ZoneLink:
    """Shows zones and passes changes on."""

    def __init__(self, node: Node) -> None:
        first: _Zones = (), ""
        self._topic = RequestTopic(node, "zone", _read_zones, first)

    def describe(self) -> dict[str, object]:
        """Describe zones for a page: name, percent (0: keep out) and corners; whether they can be changed."""
        found, problem = self._topic.state
        zones = [
            {"name": zone.name, "percent": zone.percent, "corners": [[round(c, 3) for c in p] for p in zone.points]}
            for zone in found
        ]
        return {"served": self._topic.served(), "zones": zones, "problem": problem}

    def change(self, request: PutZone | DeleteZone, done: Done) -> bool:
        """Request a change; `done` is called with the error, or ''. Return False if no map server has zones."""
        value: Mapping[str, object]
        if isinstance(request, PutZone):
            zone = Zone(request.zone, "speed" if request.percent else "keep-out", request.corners, request.percent)
            value = {"do": "put", "zone": asdict(zone)}
        else:
            value = {"do": "delete", "name": request.zone}
        return self._topic.ask(value, done)


def _read_zones(found: Mapping[str, Any]) -> _Zones:
    """Read zones, and the error about them."""
    return tuple(read_zone(each) for each in found["zones"][:MOST_ZONES]), printable(str(found["problem"]))[:300]
