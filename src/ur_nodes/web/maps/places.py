"""Places of the map that pages show: the waypoints that `keyboard_navigate` keeps, in the same file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ur.maps.names import PLACE_NAME
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.web.wire.map_requests import ForgetPlace, NamePlace
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2

MOST_PLACES = 200
_LONGEST_NAME = 64


@dataclass(frozen=True, slots=True)
class Places:
    """The places of a file when it was read; without a `path` no place can be added.

    `signature` changes with the file; `problem` is why it cannot be read.
    """

    path: Path | None = None
    signature: tuple[int, ...] = ()
    places: Mapping[str, Pose2] = field(default_factory=dict)
    problem: str = ""

    def describe(self) -> dict[str, object]:
        """Describe the places for a page: x, y, yaw by name (m, m, rad), whether any can be added, and the problem."""
        return {
            "named": self.path is not None,
            "places": {name: [round(each, 3) for each in place] for name, place in self.places.items()},
            "problem": self.problem,
        }


def read_places(path: Path | None, before: Places) -> Places:
    """Read a file unless it is unchanged since `before`. Without a path there are no places, and none can be added."""
    if path is None:
        return Places()
    signature = _signature_of(path)
    if (path, signature) == (before.path, before.signature):
        return before
    try:
        found = WaypointStore(path).places()
    except UserError as problem:
        return Places(path, signature, {}, printable(str(problem))[:300])
    shown = {name: place for name, place in found.items() if 0 < len(name) <= _LONGEST_NAME and name.isprintable()}
    return Places(path, signature, dict(list(shown.items())[:MOST_PLACES]))


def change_places(path: Path | None, request: NamePlace | ForgetPlace) -> Mapping[str, object]:
    """Change the file of places at a page's request; return the answer for the page."""
    what = "name_place" if isinstance(request, NamePlace) else "forget_place"
    try:
        if path is None:
            raise ValueError("no map")
        store = WaypointStore(path)
        if isinstance(request, ForgetPlace):
            store.forget(request.place)
        else:
            _remember(store, request)
    except ValueError as problem:
        return {"t": "refused", "what": what, "why": str(problem)}
    except UserError as problem:
        return {"t": "refused", "what": what, "why": printable(str(problem))[:300]}
    return {"t": "done", "what": what}


def _remember(store: WaypointStore, request: NamePlace) -> None:
    """Name a place, or move the one that has the name. Raises UserError, or ValueError: no such name is allowed."""
    if not PLACE_NAME.fullmatch(request.place):
        raise ValueError("name")
    places = store.places()
    if request.place not in places and len(places) >= MOST_PLACES:
        raise ValueError("full")
    store.remember(request.place, Pose2(request.x, request.y, request.yaw))


def _signature_of(path: Path) -> tuple[int, ...]:
    """Inode, time and size of a file; empty where there is none. They change with its content."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_ino, found.st_mtime_ns, found.st_size
