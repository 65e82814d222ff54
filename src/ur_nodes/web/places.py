"""Places of the map that pages show: the waypoints that `keyboard_navigate` keeps, in the same file."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.web.wire.map_requests import ForgetPlace, NamePlace
from ur_nodes.client.waypoints import WAYPOINT_NAME, WaypointStore
from ur_nodes.geometry.pose import Pose2

MOST_PLACES = 200
_LONGEST_NAME = 64


class Places:
    """The places of one file, as they were when it was last read. Methods may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._store: WaypointStore | None = None
        self._places: dict[str, Pose2] = {}
        self._problem = ""
        self._signature: tuple[object, ...] | None = None

    def use(self, path: Path | None) -> None:
        """Read the places of a file; None: there are none, and none can be named."""
        with self._lock:
            signature = None if path is None else (path, *_stamp_of(path))
            if signature != self._signature:
                self._store = None if path is None else WaypointStore(path)
                self._read()
                self._signature = signature

    def describe(self) -> dict[str, Any]:
        """Describe them for a page: x, y, yaw by name, in m, m and rad; whether they can be named; what is wrong."""
        with self._lock:
            return {
                "named": self._store is not None,
                "places": {name: [round(each, 3) for each in place] for name, place in self._places.items()},
                "problem": self._problem,
            }

    def find(self, name: str) -> Pose2 | None:
        """Return a place; None: there is none of that name."""
        with self._lock:
            return self._places.get(name)

    def remember(self, name: str, place: Pose2) -> None:
        """Name a place, or move the one that has the name. Raises UserError, or ValueError: no such name is allowed."""
        if not WAYPOINT_NAME.match(name):
            raise ValueError("name")
        with self._lock:
            if name not in self._places and len(self._places) >= MOST_PLACES:
                raise ValueError("full")
            self._change(lambda store: store.remember(name, place))

    def forget(self, name: str) -> None:
        """Delete a place. Raises UserError, or ValueError."""
        with self._lock:
            self._change(lambda store: store.forget(name))

    def _change(self, change: Callable[[WaypointStore], object]) -> None:
        if self._store is None:
            raise ValueError("no map")
        change(self._store)
        self._read()

    def _read(self) -> None:
        self._places, self._problem = {}, ""
        if self._store is None:
            return
        try:
            found = self._store.places()
        except UserError as problem:
            self._problem = printable(str(problem))[:300]
            return
        shown = {name: place for name, place in found.items() if _is_shown(name)}
        self._places = dict(list(shown.items())[:MOST_PLACES])


def _stamp_of(path: Path) -> tuple[int, ...]:
    """Inode, time and size of a file; empty where there is none. They change with its content."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_ino, found.st_mtime_ns, found.st_size


def _is_shown(name: str) -> bool:
    return 0 < len(name) <= _LONGEST_NAME and name.isprintable()


def change_places(places: Places, request: NamePlace | ForgetPlace) -> Mapping[str, Any]:
    """Change the file of places as a page asks; the answer for the page."""
    what = "name_place" if isinstance(request, NamePlace) else "forget_place"
    try:
        if isinstance(request, NamePlace):
            places.remember(request.place, Pose2(request.x, request.y, request.yaw))
        else:
            places.forget(request.place)
    except ValueError as problem:
        return {"t": "refused", "what": what, "why": str(problem)}
    except UserError as problem:
        return {"t": "refused", "what": what, "why": printable(str(problem))[:300]}
    return {"t": "done", "what": what}
