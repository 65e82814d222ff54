"""The watch over the file of the map's places: which one it is, and what other programs have changed in it."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import rospy

from ur_nodes.client.waypoints import PlaceSettings, choose_file, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.places import Places

_PERIOD = 1.0  # s
_PARAMETERS_EVERY = 3  # periods


class PlaceFile:
    """Keeps `places` as the file is, from a thread of its own, until shutdown. `keeper` is the node that keeps it."""

    def __init__(self, places: Places, keeper: str = "keyboard_navigate") -> None:
        self._places, self._keeper = places, rospy.resolve_name(keeper)
        self._grid: Grid | None = None
        self._chosen: tuple[PlaceSettings, Grid | None] | None = None
        self._path: Path | None = None
        self._awake = threading.Event()
        rospy.on_shutdown(self._awake.set)
        threading.Thread(target=self._run, name="places", daemon=True).start()

    def show(self, grid: Grid | None) -> None:
        """The map is this one now."""
        self._grid = grid
        self._awake.set()

    @quiet_at_end
    def _run(self) -> None:
        count, settings = 0, PlaceSettings()
        while not rospy.is_shutdown():
            if count % _PARAMETERS_EVERY == 0:
                settings = self._ask(settings)
            count += 1
            self._step(settings, self._grid)
            self._awake.wait(_PERIOD)
            self._awake.clear()

    def _ask(self, before: PlaceSettings) -> PlaceSettings:
        try:
            return read_settings(rospy.get_param(self._keeper, None))
        except Exception:  # a master that does not answer has changed nothing
            return before

    def _step(self, settings: PlaceSettings, grid: Grid | None) -> None:
        before = self._chosen
        if before is None or before[0] != settings or before[1] is not grid:
            self._chosen = settings, grid
            self._path = choose_file(settings, grid, os.environ)
        self._places.use(self._path)
