"""Zones of the map that is served: published as masks and as polygons, and changed on request."""

from __future__ import annotations

import json
import os
import threading
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import rospy
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import String

from ur.maps.record import RECORD, Zone, ZoneKind, read_zone
from ur.maps.zone_mask import draw_mask
from ur.maps.zones import delete_zone, find_home, make_zone, put_zone
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.changes import read_change
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.grid_message import grid_message

ZONES, REQUEST = "zones", "zone_request"
_TOPICS: dict[ZoneKind, str] = {"keep-out": "keepout_filter_mask", "speed": "speed_filter_mask"}
_PERIOD = 1.0  # s between two looks at the file


class ZoneServer:
    """Publishes the zones of a map when they have changed, also where another program has changed them.

    `zones` (std_msgs/String, JSON, latched) has them as polygons, and the answer to the last request on
    `zone_request`: {"id": text, "do": "put", "zone": {...}} or {"id": text, "do": "delete", "name": text}.
    A mask is published (latched) from the first zone of its kind on.
    """

    def __init__(self, map_file: Path, grid: Grid, frame_id: str) -> None:
        self._store, self._name = find_home(map_file, os.environ)
        self._grid, self._frame = grid, frame_id
        self._stamp: tuple[int, ...] | None = None
        self._zones: tuple[Zone, ...] = ()
        self._answer: dict[str, str] | None = None
        self._masks: dict[ZoneKind, rospy.Publisher] = {}
        self._lock = threading.Lock()
        self._polygons = rospy.Publisher(ZONES, String, queue_size=1, latch=True)
        self._look()
        rospy.Subscriber(REQUEST, String, self._on_request, queue_size=10)
        threading.Thread(target=self._run, name="zones", daemon=True).start()

    @quiet_at_end
    def _run(self) -> None:
        while not rospy.is_shutdown():
            threading.Event().wait(_PERIOD)
            self._look()

    def _look(self, *, answered: bool = False) -> None:
        """Publish what the file says, if it has changed or a request was answered."""
        with self._lock:
            stamp = _stamp_of(self._store.path(self._name) / RECORD)
            if stamp == self._stamp and not answered:
                return
            problem = ""
            try:
                zones = self._store.record(self._name).zones
            except UserError as found:
                zones, problem = self._zones, printable(str(found))[:300]
                rospy.logerr("%s", problem)
            first = self._stamp is None
            self._stamp = stamp
            self._publish(zones, problem, all_masks=first)

    def _publish(self, zones: tuple[Zone, ...], problem: str, *, all_masks: bool) -> None:
        changed = zones != self._zones or all_masks
        self._zones = zones
        value = {"zones": [asdict(zone) for zone in zones], "problem": problem, "answer": self._answer}
        self._polygons.publish(String(json.dumps(value, separators=(",", ":"))))
        for kind, topic in _TOPICS.items() if changed else ():
            mask = draw_mask(zones, kind, self._grid)
            if mask is None and kind not in self._masks:
                continue
            if kind not in self._masks:
                self._masks[kind] = rospy.Publisher(topic, OccupancyGrid, queue_size=1, latch=True)
            values = np.zeros((1, 1), np.int8) if mask is None else mask.values
            origin = Pose2(0.0, 0.0, 0.0) if mask is None else Pose2(*mask.origin, 0.0)
            grid = Grid(values, self._grid.resolution, origin)
            self._masks[kind].publish(grid_message(grid, self._frame, rospy.Time.now()))

    @quiet_at_end
    def _on_request(self, message: String) -> None:
        request = read_change(message.data)
        if request is None:
            rospy.logerr_throttle(10.0, f"{rospy.resolve_name(REQUEST)}: not a request, expected JSON with an id")
            return
        problem = ""
        try:
            self._obey(request)
        except UserError as found:
            problem = found.diagnostics[0].message
        except (ValueError, TypeError) as found:
            problem = str(found)
        except OSError as found:
            problem = f"the zones cannot be written: {(found.strerror or str(found)).lower()}"
        self._answer = {"id": request["id"], "problem": printable(problem)[:300]}
        self._look(answered=True)

    def _obey(self, request: dict[str, Any]) -> None:
        """Change the zones. Raises UserError, ValueError, TypeError or OSError: they are as before."""
        if request.get("do") == "put":
            zone = read_zone(request.get("zone"))
            zone = make_zone(zone.name, zone.kind, zone.points, zone.percent)
            put_zone(self._store, self._name, zone, self._grid)
        elif request.get("do") == "delete":
            delete_zone(self._store, self._name, str(request.get("name", "")), self._grid)
        else:
            raise ValueError("do: expected put or delete")


def _stamp_of(path: Path) -> tuple[int, ...]:
    """Inode, time and size of a file; empty where there is none. They change with its content."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_ino, found.st_mtime_ns, found.st_size
