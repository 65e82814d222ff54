"""Zones of the map that pages show: those of the map server, which changes them on request and stores them."""

from __future__ import annotations

import itertools
import json
import threading
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import rospy
from std_msgs.msg import String

from ur.maps.record import MOST_ZONES, Zone, read_zone
from ur.source.printable import printable
from ur.web.wire.requests import DeleteZone, PutZone
from ur_nodes.rosio.ending import quiet_at_end

_LONGEST = 2_000_000  # characters of all zones
_MOST_WAITING = 100


class ZoneLink:
    """Shows zones and passes changes on. Methods may be called from any thread."""

    def __init__(self, name: str) -> None:
        """`name` begins the ids of requests."""
        self._name = name
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._waiting: dict[str, Callable[[str], None]] = {}
        self._zones: tuple[Zone, ...] = ()
        self._problem = ""
        self._requests = rospy.Publisher("zone_request", String, queue_size=10)
        rospy.Subscriber("zones", String, self._on_zones, queue_size=1)

    def describe(self) -> dict[str, Any]:
        """Describe them for a page: name, percent (0: keep out) and corners; whether they can be changed."""
        served = self._requests.get_num_connections() > 0
        with self._lock:
            zones = [
                {"name": zone.name, "percent": zone.percent, "corners": [[round(c, 3) for c in p] for p in zone.points]}
                for zone in self._zones
            ]
            return {"served": served, "zones": zones, "problem": self._problem}

    def change(self, request: PutZone | DeleteZone, done: Callable[[str], None]) -> bool:
        """Ask for a change; `done` is called with what is wrong, or ''. Return False: no map server has zones."""
        if not self._requests.get_num_connections():
            return False
        value: Mapping[str, Any]
        if isinstance(request, PutZone):
            zone = Zone(request.zone, "speed" if request.percent else "keep-out", request.corners, request.percent)
            value = {"do": "put", "zone": asdict(zone)}
        else:
            value = {"do": "delete", "name": request.zone}
        with self._lock:
            key = f"{self._name}-{next(self._numbers)}"
            self._waiting[key] = done
            while len(self._waiting) > _MOST_WAITING:
                del self._waiting[next(iter(self._waiting))]
        self._requests.publish(String(json.dumps({"id": key, **value})))
        return True

    @quiet_at_end
    def _on_zones(self, message: String) -> None:
        value = _read(message.data)
        if value is None:
            rospy.logwarn_throttle(10.0, "zones: not what a map server publishes; they are not shown")
            return
        zones, problem, answer = value
        with self._lock:
            self._zones, self._problem = zones, problem
            done = self._waiting.pop(answer[0], None) if answer else None
        if done is not None and answer is not None:
            done(answer[1])


def _read(text: str) -> tuple[tuple[Zone, ...], str, tuple[str, str] | None] | None:
    """Zones, what is wrong with them, and id and problem of the last answer; None: the text is none of these."""
    if len(text) > _LONGEST:
        return None
    try:
        found = json.loads(text)
        zones = tuple(read_zone(each) for each in found["zones"][:MOST_ZONES])
        problem, answer = found["problem"], found["answer"]
        answered = None if answer is None else (str(answer["id"]), printable(str(answer["problem"]))[:300])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    return zones, printable(str(problem))[:300], answered
