"""Errors of paths and maps against a reference."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench.mapping_parts.log import Floats, Log
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion
from scipy.spatial import cKDTree

from ur.worlds.map_file import MapImage
from ur_nodes.geometry.grid import OCCUPIED, Grid

_NEAR = 0.05  # m
_LOOP = (1.0, 50.0)  # m: poses so near to each other after so long a way are a loop


@dataclass(frozen=True, slots=True)
class Fit:
    """A rotation (rad) followed by a shift (m) that brings one path onto another."""

    yaw: float
    x: float
    y: float

    def apply(self, points: Floats) -> Floats:
        """The points (n, 2), moved."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        moved: Floats = points @ np.array(((c, s), (-s, c))) + (self.x, self.y)
        return moved


def best_fit(path: Floats, reference: Floats) -> Fit:
    """The motion that brings a path (n, 2 or 3) nearest to a reference, by least squares; rows of nan are left out."""
    known = np.isfinite(path[:, 0])
    path, reference = path[known, :2], reference[known, :2]
    a, b = path - path.mean(axis=0), reference - reference.mean(axis=0)
    cross = a.T @ b
    yaw = math.atan2(cross[0, 1] - cross[1, 0], cross[0, 0] + cross[1, 1])
    turned = Fit(yaw, 0.0, 0.0).apply(path.mean(axis=0)[None])[0]
    shift = reference.mean(axis=0) - turned
    return Fit(yaw, float(shift[0]), float(shift[1]))


def errors_after_fit(path: Floats, reference: Floats) -> Floats:
    """The distances in m of a path (n, 3), but for rows of nan, from a reference after the best fit of the whole."""
    known = np.isfinite(path[:, 0])
    moved = best_fit(path, reference).apply(path[known, :2])
    distances: Floats = np.hypot(*(moved - reference[known, :2]).T)
    return distances


def peak_memory() -> float:
    """The most memory in MB that this process has held since its program began.

    Unlike `ru_maxrss`, which begins with what the parent process held.
    """
    status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    return next(float(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM:")) / 1e3


def rms(values: Floats) -> float:
    """The root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def score_map(grid: Grid, fit: Fit, log: Log, plan: MapImage) -> float:
    """The F score of a map's occupied cells.

    Precision: the share of them whose centre is within 0.05 m of a cell of the true walls. Recall: the share of the
    true walls' outermost cells, of those that a beam of the log ended on, that are within 0.05 m of an occupied cell.
    """
    yaw = plan.origin[2]
    walls = plan.walls
    outer = walls & ~binary_erosion(walls, border_value=1)
    x, y = plan.origin[:2]
    place = Fit(yaw, x, y)
    surface = place.apply(np.asarray((np.argwhere(outer)[:, ::-1] + 0.5) * plan.resolution, dtype=np.float64))
    half = 0.5 * plan.resolution
    seen = surface[_seen(surface, log)]
    cells = fit.apply(grid.points_of_cells(np.argwhere(grid.values == OCCUPIED)))
    if not len(cells) or not len(seen):
        return 0.0
    # To the surface of a wall's cell, not to its centre.
    precision = np.mean(cKDTree(surface).query(cells)[0] <= _NEAR + half)
    recall = np.mean(cKDTree(cells).query(seen)[0] <= _NEAR + half)
    return float(2.0 * precision * recall / max(1e-9, precision + recall))


def _seen(surface: Floats, log: Log) -> NDArray[np.bool_]:
    """Which of the points (n, 2) on walls beams of the log ended on, if it is drawn at the true poses."""
    seen = np.zeros(len(surface), dtype=bool)
    tree = cKDTree(surface)
    for ranges, (x, y, yaw) in zip(log.ranges[::3], log.reference[::3], strict=True):
        hit = np.isfinite(ranges)
        ends = log.directions[hit] * ranges[hit, None].astype(np.float64) + log.mount[:2]
        distances, numbers = tree.query(Fit(yaw, x, y).apply(ends), distance_upper_bound=0.06)
        seen[numbers[np.isfinite(distances)]] = True
    return seen


def relation_errors(path: Floats, log: Log) -> tuple[Floats, Floats]:
    """The errors in m and degrees of relative poses over loops: near to each other, with 50 m of travel between."""
    pairs = find_loops(log.reference) if log.loops is None else log.loops
    pairs = pairs[np.isfinite(path[pairs, 0]).all(axis=1)]
    if not len(pairs):
        return np.zeros(0), np.zeros(0)
    found, true = (_relative(poses[pairs[:, 0]], poses[pairs[:, 1]]) for poses in (path, log.reference))
    turns = np.abs(np.remainder(found[:, 2] - true[:, 2] + math.pi, 2.0 * math.pi) - math.pi)
    return np.hypot(*(found[:, :2] - true[:, :2]).T), np.degrees(turns)


def find_loops(reference: Floats) -> NDArray[np.intp]:
    """The pairs (n, 2) of poses that are near to each other, with 50 m of travel between."""
    way = travelled(reference)
    pairs = cKDTree(reference[:, :2]).query_pairs(_LOOP[0], output_type="ndarray")
    loops: NDArray[np.intp] = pairs[np.abs(way[pairs[:, 1]] - way[pairs[:, 0]]) > _LOOP[1]]
    return loops


def travelled(path: Floats) -> Floats:
    """The way in m (n) from the first pose to each one of a path."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path[:, :2], axis=0).T))))


def _relative(first: Floats, second: Floats) -> Floats:
    delta = second - first
    c, s = np.cos(first[:, 2]), np.sin(first[:, 2])
    return np.column_stack((c * delta[:, 0] + s * delta[:, 1], c * delta[:, 1] - s * delta[:, 0], delta[:, 2]))
