"""Walls of the map that is served: drawn, erased and restored on request, and published at once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import rospy
from std_msgs.msg import String

from ur.maps.store import own_store
from ur.maps.walls import is_restorable
from ur.maps.zones import find_home
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur_nodes.geometry.grid import Grid
from ur_nodes.mapping.changes import change_walls, read_change
from ur_nodes.rosio.ending import quiet_at_end

WALLS, REQUEST = "walls", "wall_request"


class WallServer:
    """Changes the walls of a stored map; `use` takes the new one. Maps that are files of others stay as they are.

    `walls` (std_msgs/String, JSON, latched) has the `name` of the map ('': it cannot be changed), whether the last
    change is `restorable`, and the `answer` to the last request on `wall_request`: {"id": text, "map": name, "do":
    "draw", "strokes": [edit, ...]} or "do": "restore".
    """

    def __init__(self, map_file: Path, grid: Grid, use: Callable[[Grid], None]) -> None:
        self._store, name = find_home(map_file, os.environ)
        self._name = name if self._store == own_store(os.environ) else ""
        self._grid, self._use = grid, use
        self._status = rospy.Publisher(WALLS, String, queue_size=1, latch=True)
        self._publish(None)
        rospy.Subscriber(REQUEST, String, self._on_request, queue_size=5)

    def _publish(self, answer: dict[str, str] | None) -> None:
        restorable = bool(self._name) and is_restorable(self._store, self._name)
        value = {"name": self._name, "restorable": restorable, "answer": answer}
        self._status.publish(String(json.dumps(value, separators=(",", ":"))))

    @quiet_at_end
    def _on_request(self, message: String) -> None:
        request = read_change(message.data)
        if request is None:
            rospy.logerr_throttle(10.0, f"{rospy.resolve_name(REQUEST)}: not a request, expected JSON with an id")
            return
        problem = ""
        try:
            change_walls(self._store, self._name, self._grid, request, self._use_new)
        except UserError as found:
            problem = found.diagnostics[0].message
        except (ValueError, TypeError) as found:
            problem = str(found)
        except OSError as found:
            problem = f"the map cannot be written: {(found.strerror or str(found)).lower()}"
        self._publish({"id": request["id"], "problem": printable(problem)[:300]})

    def _use_new(self, grid: Grid) -> None:
        self._grid = grid
        self._use(grid)
        rospy.loginfo("walls of map %s were changed on request", self._name)
