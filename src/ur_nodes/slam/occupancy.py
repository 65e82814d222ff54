"""The occupancy grid of keyframes: the walls that their beams hit, and the cells that they passed.

Each keyframe's share is kept as the pose that it was drawn at, so that it can be removed and drawn again after the
graph has moved it. Where a map was continued, the keyframes of the later drive count many times those before, so that
furniture and walls that were moved between the drives are drawn where they were seen last.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import FREE, OCCUPIED, UNKNOWN, Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats

_WINDOW = 4  # beams to either side whose ends are averaged
_REACH = 0.15  # m: as far as these may lie from the middle one
_STEP = 0.04  # m: ends farther off the surface belong to another one


def wall_points(scan: MapScan, depth: float) -> Floats:
    """Return a point (n, 2) in the wall for each hit of a scan, `depth` m behind its surface, in the robot's frame.

    With half a cell as the depth, the nearer edges of the cells that hold these points lie on the surface on average.
    The cells that hold the hits themselves would reach out of the wall, by half a cell on average towards the
    lidar. The noise along the normal is averaged over neighbours. Hits whose surface is not known stay as they are.
    """
    hits = scan.hits.astype(np.float64)
    if not len(hits):
        return hits
    nearest = np.arange(len(hits)) // -(-len(hits) // len(scan.facing))
    facing = scan.facing[nearest].astype(np.float64)
    normals = np.column_stack((np.cos(facing), np.sin(facing)))
    # The mean distance (n) of each hit's neighbours from it, along its normal
    places = np.arange(len(hits))[:, None] + np.arange(-_WINDOW, _WINDOW + 1)
    inside = (places >= 0) & (places < len(hits))
    delta = hits[np.clip(places, 0, len(hits) - 1)] - hits[:, None]
    along = (delta * normals[:, None]).sum(axis=2)
    counted = inside & (np.square(delta).sum(axis=2) <= _REACH * _REACH) & (np.abs(along) <= _STEP)
    offsets: NDArray[np.float64] = (along * counted).sum(axis=1) / counted.sum(axis=1)
    shift = np.where(scan.flat[nearest], offsets - depth, 0.0)
    moved: Floats = hits + normals * shift[:, None]
    return moved


_MARGIN = 1.0  # m that the map grows beyond what was seen
_PACE = 0.5  # of a cell: between two samples of a beam
_LATER = 32  # times as much as the drive before it counts a drive
_DRIVES = 4  # that are distinguished; all before count like the first of these
_SPARED = 1.5  # cells before the end of a beam that do not count as passed: a thin wall seen at an angle is kept


class OccupancyMap:
    """Counts of hits and passes per cell of `resolution` m. A cell is a wall from a share `threshold` of hits on."""

    def __init__(self, resolution: float = 0.05, threshold: float = 0.25, reach: float = math.inf) -> None:
        """`reach` (m) is how far beams are drawn; cells beyond are neither free nor occupied."""
        self._resolution = resolution
        self.threshold = threshold
        self._reach = reach
        self._corner = np.zeros(2, np.intp)  # column and row, in cells from the origin of the map, of the arrays' first
        self._hits = np.zeros((0, 0), np.int32)
        self._passes = np.zeros((0, 0), np.int32)
        self._drawn: list[tuple[Pose2, int, MapScan]] = []  # pose, weight and scan of each keyframe

    def include(self, low: tuple[float, float], high: tuple[float, float]) -> None:
        """Extend the map to at least these corners, m."""
        corners = np.floor(np.array((low, high)) / self._resolution).astype(np.intp)
        self._grow(corners[0], corners[1])

    def update(
        self, poses: Sequence[Pose2], scans: Sequence[MapScan], drives: Sequence[int] = (), most: int | None = None
    ) -> bool:
        """Draw new keyframes, and again those that have moved or whose scan was replaced; at most so many.

        Returns whether all is up to date. `drives` are the numbers of the keyframes with which a later drive begins,
        rising.
        """
        budget = len(poses) * 2 if most is None else most
        starts = np.array(drives[-(_DRIVES - 1) :], np.intp)
        weights = np.power(_LATER, np.searchsorted(starts, np.arange(len(poses)), side="right")).tolist()
        for number, (pose, scan, weight) in enumerate(zip(poses, scans, weights, strict=True)):
            fresh = number >= len(self._drawn)
            if not fresh and self._is_current(self._drawn[number], pose, weight, scan):
                continue
            if budget <= 0:
                return False
            budget -= 1
            if fresh:
                self._drawn.append((pose, weight, scan))
            else:
                before, times, old = self._drawn[number]
                self._draw(before, old, -times)
                self._drawn[number] = (pose, weight, scan)
            self._draw(pose, scan, weight)
        return True

    def grid(self) -> Grid:
        """The map as it is drawn: occupied, free and unknown cells."""
        seen = self._hits + self._passes
        walls = self._hits >= np.maximum(1.0, self.threshold * seen)
        values = np.where(seen > 0, np.where(walls, OCCUPIED, FREE), UNKNOWN).astype(np.int8)
        low = self._corner * self._resolution
        return Grid(values, self._resolution, Pose2(float(low[0]), float(low[1]), 0.0))

    def _is_current(self, drawn: tuple[Pose2, int, MapScan], after: Pose2, weight: int, scan: MapScan) -> bool:
        before = drawn[0]
        if drawn[1] != weight or drawn[2] is not scan:
            return False
        shift = math.hypot(after.x - before.x, after.y - before.y)
        return shift <= 0.2 * self._resolution and abs(wrap_angle(after.yaw - before.yaw)) <= 0.05 * self._resolution

    def _draw(self, pose: Pose2, scan: MapScan, times: int) -> None:
        origin = _placed(pose, scan.origin[None])[0]
        hits = _placed(pose, scan.hits.astype(np.float64))
        misses = _placed(pose, scan.misses.astype(np.float64))
        far = np.hypot(*(hits - origin).T) > self._reach
        ends = np.vstack((hits, misses))
        struck = self._cells(_placed(pose, wall_points(scan, 0.5 * self._resolution)[~far]))
        passed = self._cells(_samples(origin, ends, len(far), self._reach, self._resolution))
        everything = np.vstack((struck, passed, self._cells(origin[None])))
        low, high = everything.min(axis=0), everything.max(axis=0)
        self._grow(low, high)
        width, height = high - low + 1  # only the cells round the scan are touched
        touched = np.zeros((2, height, width), dtype=bool)
        for each, cells in zip(touched, (struck, passed), strict=True):
            columns, rows = (cells - low).T
            each[rows, columns] = True
        column, row = low - self._corner
        part = (slice(row, row + height), slice(column, column + width))
        self._hits[part] += times * touched[0]
        self._passes[part] += times * (touched[1] & ~touched[0])

    def _cells(self, points: Floats) -> NDArray[np.intp]:
        cells: NDArray[np.intp] = np.floor(points / self._resolution).astype(np.intp)
        return cells

    def _grow(self, low: NDArray[np.intp], high: NDArray[np.intp]) -> None:
        """Make the arrays hold cells `low` to `high` (column, row)."""
        height, width = self._hits.shape
        end = self._corner + np.array((width, height))
        if self._hits.size and np.all(low >= self._corner) and np.all(high < end):
            return
        margin = math.ceil(_MARGIN / self._resolution)
        new_low, new_high = low - margin, high + margin + 1
        if self._hits.size:
            new_low = np.where(low < self._corner, new_low, self._corner)
            new_high = np.where(high >= end, new_high, end)
        columns, rows = new_high - new_low
        left, below = self._corner - new_low if self._hits.size else (0, 0)
        for name in ("_hits", "_passes"):
            larger = np.zeros((rows, columns), np.int32)
            larger[below : below + height, left : left + width] = getattr(self, name)
            setattr(self, name, larger)
        self._corner = new_low


def _placed(pose: Pose2, points: Floats) -> Floats:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    placed: Floats = points @ np.array(((c, s), (-s, c))) + (pose.x, pose.y)
    return placed


def _samples(origin: Floats, ends: Floats, hits: int, reach: float, resolution: float) -> Floats:
    """Return points along beams that touch each cell; those just before the first `hits` ends are left out."""
    delta = ends - origin
    lengths = np.hypot(*delta.T)
    open_ = lengths.copy()
    open_[:hits] -= _SPARED * resolution
    open_ = np.clip(np.minimum(open_, reach), 0.0, None)
    step = _PACE * resolution
    counts = np.floor(open_ / step).astype(np.intp) + 1
    beams = np.repeat(np.arange(len(ends)), counts)
    first = np.cumsum(counts) - counts
    distances = (np.arange(len(beams)) - first[beams]) * step
    points: Floats = origin + delta[beams] / np.maximum(lengths, 1e-9)[beams, None] * distances[:, None]
    return points
