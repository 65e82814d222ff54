"""Zones of the map for pages: the map server changes and stores them on request."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from ur.maps.record import MOST_ZONES, Zone, read_zone
from ur.source.printable import printable
from ur.web.wire.map_requests import DeleteZone, PutZone
from ur_nodes.ports.node import Node
from ur_nodes.web.maps.request_topic import Done, RequestTopic

_Zones = tuple[tuple[Zone, ...], str]


class ZoneLink:
    """Shows zones and passes changes on."""

    def __init__(self, node: Node) -> None:
        first: _Zones = (), ""
        self._topic = RequestTopic(node, "zone", _read, first)

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


def _read(found: Mapping[str, Any]) -> _Zones:
    """Read zones, and the error about them."""
    return tuple(read_zone(each) for each in found["zones"][:MOST_ZONES]), printable(str(found["problem"]))[:300]
