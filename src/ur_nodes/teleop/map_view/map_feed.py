"""Lines of a growing map with the robot and its scan, drawn a few times a second."""

from collections.abc import Callable, Sequence

from ur_nodes.client.navigation import RobotState
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map
from ur_nodes.teleop.map_view.glyphs import Mark
from ur_nodes.teleop.map_view.growing_map import GrowingMap, Zoom, draw_map_lines, follow, prepare_map, press_zoom
from ur_nodes.teleop.map_view.picture import Viewport

_EVERY = 0.25  # s between two pictures

Additions = Callable[[RobotSnapshot], tuple[RobotSnapshot, Sequence[Mark]]]
"""Adds goal and path to a snapshot, and characters to draw on the map. Called by the thread of `lines`."""


class MapFeed:
    """Subscribes to `map`, `scan` and transforms. Only the thread of the user interface calls `lines` and `press`."""

    def __init__(
        self, node: Node, map_frame: str, base_frame: str, *, colour: bool, additions: Additions | None = None
    ) -> None:
        self._additions = additions
        self._colour = colour
        self._map: GrowingMap | None = None
        self._view: Viewport | None = None
        self._zoom: Zoom | float = Zoom.AUTOMATIC
        self._shown: tuple[float, tuple[int, int], list[str]] = (0.0, (0, 0), [])
        self._robot = RobotState(node, map_frame, base_frame)
        work: NewestWork[Map, GrowingMap] = NewestWork(node, "map", lambda map: prepare_map(map.grid), self._take)
        node.subscribe("map", Map, work.ask, Quality.LATCHED)

    def lines(self, columns: int, rows: int, now: float) -> list[str]:
        """Return the map as `rows` lines of `columns` characters, at most 0.25 s older than `now` (s)."""
        drawn_at, size, lines = self._shown
        if size == (columns, rows) and 0.0 <= now - drawn_at < _EVERY:
            return lines
        snapshot = RobotSnapshot(pose=self._robot.pose(), scan=self._robot.scan())
        marks: Sequence[Mark] = ()
        if self._additions:
            snapshot, marks = self._additions(snapshot)
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

    def _take(self, _map: Map, growing: GrowingMap) -> None:
        self._map = growing
