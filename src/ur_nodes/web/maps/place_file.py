"""The file of the map's places, which pages and other programs change."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from ur.web.wire.map_requests import ForgetPlace, NamePlace
from ur_nodes.client.waypoints import PlaceSettings, choose_file, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.web.maps.places import Places, change_places, read_places

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
