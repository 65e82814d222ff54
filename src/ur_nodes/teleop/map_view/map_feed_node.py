"""The map that grows: topics and tf to lines on a terminal, drawn a few times a second."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import rospy

from ur.maps.viewport import Viewport
from ur.source.diagnostic import UserError
from ur_nodes.client.model import Snapshot
from ur_nodes.rosio.grid_message import GridMessage, grid_of_message
from ur_nodes.teleop.map_view.glyphs import Mark
from ur_nodes.teleop.map_view.growing_map import GrowingMap, Zoom, draw_map_lines, follow, prepare_map, press_zoom
from ur_nodes.teleop.navigator.robot_state_node import RobotState

_EVERY = 0.25  # s between two pictures: drawing must not keep velocities waiting
_LOGGED_EVERY = 10.0  # s


class Additions(Protocol):
    """Adds what a program knows besides the map and the robot."""

    def add(self, snapshot: Snapshot) -> Snapshot:
        """The snapshot with goal and path."""

    def marks(self) -> Sequence[Mark]:
        """Characters to draw on the map."""


class MapFeed:
    """Subscribes to `map`, `scan` and tf. `lines` is called by one thread."""

    def __init__(self, map_frame: str, base_frame: str, *, colour: bool, additions: Additions | None = None) -> None:
        self._additions = additions
        self._colour = colour
        self._map: GrowingMap | None = None
        self._view: Viewport | None = None
        self._zoom: Zoom | float = Zoom.AUTOMATIC
        self._shown: tuple[float, tuple[int, int], list[str]] = (0.0, (0, 0), [])
        self._robot = RobotState(map_frame, base_frame)
        rospy.Subscriber("map", GridMessage, self._take, queue_size=1)

    def lines(self, columns: int, rows: int, now: float) -> list[str]:
        """The map as it was at most a quarter of a second before `now` (s), on so many characters."""
        drawn_at, size, lines = self._shown
        if size == (columns, rows) and 0.0 <= now - drawn_at < _EVERY:
            return lines
        snapshot = Snapshot(pose=self._robot.pose(), scan=self._robot.scan())
        marks: Sequence[Mark] = ()
        if self._additions:
            snapshot, marks = self._additions.add(snapshot), self._additions.marks()
        growing = self._map
        self._view = follow(self._view, growing, snapshot, columns, rows, self._zoom)
        lines = draw_map_lines(growing, snapshot, self._view, colour=self._colour, marks=marks)
        self._shown = (now, (columns, rows), lines)
        return lines

    def press(self, key: str) -> None:
        """Zoom by a key of the map: `+`, `-`, `0` for all of it, `f` to follow the robot; other keys do nothing."""
        zoom = press_zoom(self._zoom, key, self._view)
        if zoom is not None:
            self._zoom = zoom
            self._shown = (0.0, (0, 0), [])

    def _take(self, message: Any) -> None:
        try:
            self._map = prepare_map(grid_of_message(message))
        except UserError as problem:
            rospy.logerr_throttle(_LOGGED_EVERY, str(problem))
