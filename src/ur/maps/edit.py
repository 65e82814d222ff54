"""Manual changes of a map: erase, draw walls, forbid areas, rotate. Pure: cells (height, width) in, cells out."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ur.maps.record import MapEdit, MapRecord
from ur.maps.scan_file import StoredGraph
from ur.worlds.cells import FREE, OCCUPIED, UNKNOWN, CellFrame, look_up

Values = NDArray[np.int8]
Points = NDArray[np.float64]
Origin = tuple[float, float, float]
"""A pose, or a motion in the plane: m, m, rad."""

_MOST_CELLS = 50_000_000  # of a map that was turned
_MOST_SAMPLES = 1_000_000  # of a line
_CONNECTED = 0.71  # cells: half a diagonal, so that a narrow brush leaves no gaps
_PIECE = 64.0  # cells of a line that are drawn at once: the box round a long one is most of the map
_PACE = 0.4  # cells between two samples of a line, so that it has no gaps
_LEAST_WALLS = 10  # cells, to propose a turn
_SAMPLED_WALLS = 20_000  # cells that are looked at, about
_COARSE, _FINEST = math.radians(1.0), math.radians(0.1)  # steps of a proposal


class Lattice(CellFrame):
    """The cells of a map without their values: `shape` (rows, columns), m, and the pose of the corner (m, m, rad)."""

    __slots__ = ("_shape", "origin", "resolution")

    def __init__(self, shape: tuple[int, int], resolution: float, origin: Origin) -> None:
        self._shape = shape
        self.resolution = resolution
        self.origin = origin

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of rows and columns."""
        return self._shape


def apply_edits(values: Values, resolution: float, origin: Origin, edits: Sequence[MapEdit]) -> Values:
    """Apply edits to the cells (height, width) of a map, row 0 at the bottom; edits outside are ignored.

    Erased walls become floor. Cells on a wall, and those of a keep-out polygon, become walls.
    """
    if not edits:
        return values
    height, width = values.shape
    frame = Lattice((height, width), resolution, origin)
    result: Values = values.copy()
    for edit in edits:
        points = np.array(edit.points, np.float64)
        if edit.width:
            inside = brush_line(frame, points, edit.width)
        else:
            inside = _line(frame, points) if edit.kind == "wall" else fill_polygon(frame, points)
        if edit.kind == "erase":
            inside &= result > FREE
            result[inside] = FREE
        else:
            result[inside] = OCCUPIED
    return result


def move_record(record: MapRecord, motion: Origin) -> MapRecord:
    """Return a record with its edits and zones moved by a pose (m, m, rad): points p become motion * p."""
    edits = (replace(each, points=tuple(move_point(p, motion) for p in each.points)) for each in record.edits)
    zones = (replace(each, points=tuple(move_point(p, motion) for p in each.points)) for each in record.zones)
    return replace(record, edits=tuple(edits), zones=tuple(zones))


def move_graph(graph: StoredGraph, motion: Origin) -> StoredGraph:
    """Return a pose graph with moved keyframes; the constraints between them stay."""
    poses: Points = graph.poses.copy()
    poses[:, :2] = move_points(poses[:, :2], motion)
    poses[:, 2] = np.remainder(poses[:, 2] + motion[2] + math.pi, 2.0 * math.pi) - math.pi
    return replace(graph, poses=poses)


def move_point(point: tuple[float, float], motion: Origin) -> tuple[float, float]:
    """Rotate a point about (0, 0), then shift it."""
    c, s = math.cos(motion[2]), math.sin(motion[2])
    return motion[0] + c * point[0] - s * point[1], motion[1] + s * point[0] + c * point[1]


def move_points(points: Points, motion: Origin) -> Points:
    """Rotate points (..., 2) about (0, 0), then shift them."""
    c, s = math.cos(motion[2]), math.sin(motion[2])
    moved: Points = points @ np.array(((c, s), (-s, c))) + motion[:2]
    return moved


def turn_values(values: Values, resolution: float, origin: Origin, motion: Origin) -> tuple[Values, Origin]:
    """Redraw a map whose points are moved by `motion`; return the cells and the origin, whose yaw is 0.

    For maps without scans: walls are kept, one cell thicker at most. Raises ValueError if the result is too large.
    """
    height, width = values.shape
    frame = Lattice((height, width), resolution, origin)
    left, bottom, right, top = frame.bounds
    corners = [move_point(corner, motion) for corner in ((left, bottom), (right, bottom), (left, top), (right, top))]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    columns, rows = np.ceil((high - low) / resolution).astype(int) + 1
    if columns * rows > _MOST_CELLS:
        raise ValueError("the turned map is too large")
    ys, xs = np.mgrid[0:rows, 0:columns]
    target = np.stack((low[0] + (xs + 0.5) * resolution, low[1] + (ys + 0.5) * resolution), axis=-1)
    result = np.array(look_up(frame, values, move_points(target, _inverse(motion)), UNKNOWN))
    walls = np.argwhere(values == OCCUPIED)
    if len(walls):  # a wall of one cell may fall between the centres of the new ones
        moved = move_points(frame.points_of_cells(walls), motion)
        places = np.floor((moved - low) / resolution).astype(int)
        result[places[:, 1], places[:, 0]] = OCCUPIED
    return result, (float(low[0]), float(low[1]), 0.0)


def propose_turn(values: Values, resolution: float, origin: Origin) -> float:
    """Return the rotation (rad, at most an eighth of a circle either way) that aligns most walls with the axes.

    The best one has the sharpest profiles: sums of walls along rows and columns. 0 for a map without walls.
    """
    height, width = values.shape
    frame = Lattice((height, width), resolution, origin)
    cells = np.argwhere(values == OCCUPIED)
    if len(cells) < _LEAST_WALLS:
        return 0.0
    points = frame.points_of_cells(cells[:: max(1, len(cells) // _SAMPLED_WALLS)])
    points = points - points.mean(axis=0)

    def sharpness(turn: float) -> float:
        c, s = math.cos(turn), math.sin(turn)
        total = 0.0
        for along in (c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]):
            places = np.floor((along - along.min()) / resolution).astype(int)
            total += float(np.square(np.bincount(places).astype(float)).sum())
        return total

    step = _COARSE
    candidates = np.arange(-45, 45) * step
    while True:
        scores = [sharpness(float(each)) for each in candidates]
        best = float(candidates[int(np.argmax(scores))])
        if step <= _FINEST:
            return math.remainder(best, math.pi / 2.0)
        step /= 5.0
        candidates = best + np.arange(-6, 7) * step


def _inverse(motion: Origin) -> Origin:
    """Return the inverse of a motion."""
    c, s = math.cos(motion[2]), math.sin(motion[2])
    return -c * motion[0] - s * motion[1], s * motion[0] - c * motion[1], -motion[2]


def _line(frame: CellFrame, points: Points) -> NDArray[np.bool_]:
    """Mark the cells (height, width) along a line through points (n, 2), m."""
    marked = np.zeros(frame.shape, np.bool_)
    for start, end in pairwise(points):
        count = min(_MOST_SAMPLES, math.ceil(float(np.hypot(*(end - start))) / (_PACE * frame.resolution)) + 1)
        cells = frame.cells_of_points(start + np.linspace(0.0, 1.0, count)[:, None] * (end - start))
        cells = cells[frame.contains(cells)]
        marked[cells[:, 0], cells[:, 1]] = True
    return marked


def brush_line(frame: CellFrame, points: Points, width: float) -> NDArray[np.bool_]:
    """Mark the cells (height, width) whose centres a round brush of `width` m covers along points (n, 2), m.

    Even with a narrow brush the line has no gaps. The work is proportional to the part of the line that is on the map.
    """
    marked = np.zeros(frame.shape, np.bool_)
    centres = frame.fractions_of_points(points) - 0.5  # row, column of centres
    reach = max(width / (2.0 * frame.resolution), _CONNECTED)
    for start, end in pairwise(centres):
        pieces = min(_MOST_SAMPLES, math.ceil(float(np.hypot(*(end - start))) / _PIECE) or 1)
        joints = start + np.linspace(0.0, 1.0, pieces + 1)[:, None] * (end - start)
        low = np.floor(np.minimum(joints[:-1], joints[1:]) - reach)
        high = np.ceil(np.maximum(joints[:-1], joints[1:]) + reach) + 1
        low, high = np.clip(low, 0, frame.shape).astype(int), np.clip(high, 0, frame.shape).astype(int)
        for index in np.flatnonzero((low < high).all(axis=1)).tolist():
            (top, left), (bottom, right) = low[index].tolist(), high[index].tolist()
            box = np.ogrid[top:bottom, left:right]
            marked[top:bottom, left:right] |= _distances(box, joints[index], joints[index + 1]) <= reach
    return marked


def _distances(cells: Sequence[NDArray[np.intp]], start: Points, end: Points) -> Points:
    """Return the distances of cells, as an open grid of rows and columns, from a line segment; all in cells."""
    down, right = end - start
    rows, columns = cells[0] - start[0], cells[1] - start[1]
    share = np.clip((rows * down + columns * right) / ((down * down + right * right) or 1.0), 0.0, 1.0)
    distances: Points = np.hypot(rows - share * down, columns - share * right)
    return distances


def fill_polygon(frame: CellFrame, points: Points) -> NDArray[np.bool_]:
    """Mark the cells (height, width) whose centres lie in a polygon (n, 2), m, by the even-odd rule."""
    corners = frame.fractions_of_points(points) - 0.5  # row, column of centres
    marked = np.zeros(frame.shape, np.bool_)
    low = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, frame.shape)
    high = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 1, 0, frame.shape)
    rows, columns = np.arange(low[0], high[0])[:, None], np.arange(low[1], high[1])[None, :]
    inside = np.zeros((high[0] - low[0], high[1] - low[1]), np.bool_)
    for (row, column), (next_row, next_column) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if row == next_row:
            continue
        crosses = (row > rows) != (next_row > rows)
        inside ^= crosses & (columns < (next_column - column) * (rows - row) / (next_row - row) + column)
    marked[low[0] : high[0], low[1] : high[1]] = inside
    return marked
