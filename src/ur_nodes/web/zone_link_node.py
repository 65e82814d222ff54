"""Zones of the map that pages show: those of the map server, which changes them on request and stores them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import rospy
from std_msgs.msg import String

from ur.maps.record import MOST_ZONES, Zone, read_zone
from ur.source.printable import printable
from ur.web.wire.map_requests import DeleteZone, PutZone
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.request_topic_node import Done, RequestTopic, read_answer

_LONGEST = 2_000_000  # characters of all zones


class ZoneLink:
    """Shows zones and passes changes on. Methods may be called from any thread."""

    def __init__(self, name: str) -> None:
        """`name` begins the ids of requests."""
        self._found: tuple[tuple[Zone, ...], str] = ((), "")  # zones, and what is wrong with them
        self._topic = RequestTopic("zone_request", name)
        rospy.Subscriber("zones", String, self._on_zones, queue_size=1)

    def describe(self) -> dict[str, Any]:
        """Describe them for a page: name, percent (0: keep out) and corners; whether they can be changed."""
        found, problem = self._found
        zones = [
            {"name": zone.name, "percent": zone.percent, "corners": [[round(c, 3) for c in p] for p in zone.points]}
            for zone in found
        ]
        return {"served": self._topic.served(), "zones": zones, "problem": problem}

    def change(self, request: PutZone | DeleteZone, done: Done) -> bool:
        """Ask for a change; `done` is called with what is wrong, or ''. Return False: no map server has zones."""
        value: Mapping[str, Any]
        if isinstance(request, PutZone):
            zone = Zone(request.zone, "speed" if request.percent else "keep-out", request.corners, request.percent)
            value = {"do": "put", "zone": asdict(zone)}
        else:
            value = {"do": "delete", "name": request.zone}
        return self._topic.ask(value, done)

    @quiet_at_end
    def _on_zones(self, message: String) -> None:
        value = _read(message.data)
        if value is None:
            rospy.logwarn_throttle(10.0, "zones: not what a map server publishes; they are not shown")
            return
        zones, problem, answer = value
        self._found = (zones, problem)
        self._topic.take(answer)


def _read(text: str) -> tuple[tuple[Zone, ...], str, tuple[str, str] | None] | None:
    """Zones, what is wrong with them, and id and problem of the last answer; None: the text is none of these."""
    if len(text) > _LONGEST:
        return None
    try:
        found = json.loads(text)
        zones = tuple(read_zone(each) for each in found["zones"][:MOST_ZONES])
        problem, answer = found["problem"], read_answer(found["answer"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    return zones, printable(str(problem))[:300], answer
