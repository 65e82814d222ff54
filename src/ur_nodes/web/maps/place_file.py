"""Places of the map that pages show and change: the waypoints that `keyboard_navigate` keeps, in the same file."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ur.maps.names import PLACE_NAME
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.web.wire.map_requests import ForgetPlace, NamePlace
from ur_nodes.client.waypoints import PlaceSettings, WaypointStore, choose_file, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node

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
            # Name a place, or move the one that has the name. Raises UserError, or ValueError: no such name is allowed.
            if not PLACE_NAME.fullmatch(request.place):
                raise ValueError("name")
            places = store.places()
            if request.place not in places and len(places) >= MOST_PLACES:
                raise ValueError("full")
            store.remember(request.place, Pose2(request.x, request.y, request.yaw))
    except ValueError as problem:
        return {"t": "refused", "what": what, "why": str(problem)}
    except UserError as problem:
        return {"t": "refused", "what": what, "why": printable(str(problem))[:300]}
    return {"t": "done", "what": what}


def _signature_of(path: Path) -> tuple[int, ...]:
    """Inode, time and size of a file; empty where there is none. They change with its content."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_ino, found.st_mtime_ns, found.st_size


_PERIOD = 1.0  # s
_PARAMETERS_EVERY = 3  # periods
_LANE = "places"


class PlaceFile:
    """Keeps places equal to their file. `keeper` is the node that owns it; files are read and written on a worker."""

    def __init__(self, node: Node, keeper: str = "keyboard_navigate") -> None:
        self._node, self._keeper = node, keeper
        self._places = Places()
        self._settings = PlaceSettings()
        self._grid: Grid | None = None
        self._path: Path | None = None
        self._count = 0
        self._busy = False
        node.after(0.0, self._look, steady=True)
        node.every(_PERIOD, self._look, steady=True)

    def show(self, grid: Grid | None) -> None:
        """Use the places of this map."""
        self._grid = grid
        self._find_file()

    def describe(self) -> dict[str, object]:
        """Describe the places for a page."""
        return self._places.describe()

    def find(self, name: str) -> Pose2 | None:
        """Return the place of a name; None if there is none."""
        return self._places.places.get(name)

    def change(self, request: NamePlace | ForgetPlace, done: Callable[[Mapping[str, object]], None]) -> None:
        """Change the file at a page's request; `done` is called with the answer once the change is shown."""
        path, before = self._path, self._places

        def carry_out() -> tuple[Mapping[str, object], Places]:
            answer = change_places(path, request)
            return answer, read_places(path, before)

        def finish(found: tuple[Mapping[str, object], Places]) -> None:
            self._take(path, found[1])
            done(found[0])

        self._node.work(carry_out, finish, _LANE)

    def _look(self) -> None:
        """Read the file again if it has changed; from time to time ask the keeper for its path."""
        if self._busy:
            return
        self._count += 1
        if self._count % _PARAMETERS_EVERY == 1:
            self._busy = True
            self._node.work(self._ask, self._use, _LANE)
        else:
            self._read()

    def _ask(self) -> PlaceSettings | None:
        try:
            parameters = self._node.parameters.of(self._keeper)
            names = ("map_name", "waypoints_file", "save_service")
            return read_settings({name: parameters.any(name, "") for name in names})
        except Exception:  # a parameter server that does not answer has changed nothing
            return None

    def _use(self, settings: PlaceSettings | None) -> None:
        self._busy = False
        if settings is not None and settings != self._settings:
            self._settings = settings
            self._find_file()
        else:
            self._read()

    def _find_file(self) -> None:
        settings, grid = self._settings, self._grid
        self._node.work(lambda: choose_file(settings, grid, os.environ), self._follow, _LANE)

    def _follow(self, path: Path | None) -> None:
        self._path = path
        self._read()

    def _read(self) -> None:
        path, before = self._path, self._places
        self._node.work(lambda: read_places(path, before), lambda found: self._take(path, found), _LANE)

    def _take(self, path: Path | None, found: Places) -> None:
        if path == self._path:
            self._places = found
