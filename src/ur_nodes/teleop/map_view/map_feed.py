"""A growing map with the robot and its scan as lines for a terminal in raw mode, drawn a few times a second."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from ur.tui.screen.half_blocks import draw_half_blocks
from ur_nodes.client.navigation import RobotState
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map
from ur_nodes.teleop.map_view.glyphs import Mark, draw_glyphs, draw_marks, scale_bar
from ur_nodes.teleop.map_view.palette import DARK
from ur_nodes.teleop.map_view.picture import GridIndex, Viewport, draw_map, draw_overlay, fit_viewport, index_grid

_BEGIN = (-2.0, -2.0, 2.0, 2.0)  # m: shown while there is no map
_MARGIN = 0.5  # m round what is known
_COARSEST = 0.2  # m in a pixel: coarser than that the map moves with the robot instead
_FINEST, _FARTHEST = 0.01, 2.0  # m in a pixel, of a scale that a person chooses
_STEPS = {"+": 0.8, "=": 0.8, "-": 1.25}
_MIDDLE = 0.3  # of the view, from each side: the view moves when the robot leaves this part


@dataclass(frozen=True, slots=True, eq=False)
class GrowingMap:
    """A map prepared for drawing, and the box (left, bottom, right, top in m) of its known cells."""

    index: GridIndex
    known: tuple[float, float, float, float]


def prepare_map(grid: Grid) -> GrowingMap:
    """Prepare a map for drawing; takes some milliseconds, once for each new map."""
    cells = np.argwhere(grid.values >= 0)
    known = _BEGIN
    if len(cells):
        rows, columns = zip(cells.min(axis=0), cells.max(axis=0), strict=True)
        corners = grid.points_of_cells(np.array([(row, column) for row in rows for column in columns]))
        (left, bottom), (right, top) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        known = (left - _MARGIN, bottom - _MARGIN, right + _MARGIN, top + _MARGIN)
    return GrowingMap(index_grid(grid), known)


class Zoom(Enum):
    """The part of the map to show, if it is not chosen by a scale."""

    AUTOMATIC = (
        "automatic"  # all that is known, as long as a pixel is at most 0.2 m wide, then the robot's surroundings
    )
    WHOLE = "whole"


def press_zoom(zoom: Zoom | float, key: str, shown: Viewport | None) -> Zoom | float | None:
    """Return the choice after a key (`+`, `-`, `0`, `f`); None for other keys. `shown` is the present view."""
    if key == "0":
        return Zoom.WHOLE
    if key == "f":
        return Zoom.AUTOMATIC
    if key not in _STEPS:
        return None
    scale = zoom if isinstance(zoom, float) else shown.scale if shown else _COARSEST
    return min(max(scale * _STEPS[key], _FINEST), _FARTHEST)


def follow(
    view: Viewport | None,
    growing: GrowingMap | None,
    snapshot: RobotSnapshot,
    columns: int,
    rows: int,
    zoom: Zoom | float = Zoom.AUTOMATIC,
) -> Viewport:
    """Return the part of the map to show on `columns` x `rows` characters: all of it, or the robot's surroundings.

    `view` is the part that was shown before: round the robot it moves only when the robot comes near to the edge.
    `zoom` is the user's choice; a number is the width of a pixel in m.
    """
    whole = fit_viewport(growing.known if growing else _BEGIN, columns, 2 * rows)
    pose = snapshot.pose
    scale = zoom if isinstance(zoom, float) else _COARSEST
    if pose is None or zoom is Zoom.WHOLE or (zoom is Zoom.AUTOMATIC and whole.scale <= _COARSEST):
        return whole
    if view is not None and (view.width, view.height, view.scale) == (columns, 2 * rows, scale):
        column, row = view.to_pixel(pose.x, pose.y)
        if _MIDDLE * columns < column < (1 - _MIDDLE) * columns and _MIDDLE * 2 * rows < row < (1 - _MIDDLE) * 2 * rows:
            return view
    return Viewport(pose.x, pose.y, scale, columns, 2 * rows)


def draw_map_lines(
    growing: GrowingMap | None, snapshot: RobotSnapshot, view: Viewport, *, colour: bool, marks: Sequence[Mark] = ()
) -> list[str]:
    """Draw map, path, scan, marks and robot: `view.height` / 2 lines of `view.width` characters.

    Without `colour` walls are `#`.
    """
    picture = draw_overlay(draw_map(growing.index if growing else None, view, DARK), snapshot, view, DARK)
    glyphs = [*draw_marks(marks, view, DARK), *draw_glyphs(snapshot, {}, None, view, DARK), *scale_bar(view, DARK)]
    return draw_half_blocks(picture, "palette" if colour else "letters", glyphs)


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
        work: NewestWork[Map, GrowingMap] = NewestWork(node, "map", lambda map: prepare_map(map.grid), self._on_map)
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

    def _on_map(self, _map: Map, growing: GrowingMap) -> None:
        self._map = growing
