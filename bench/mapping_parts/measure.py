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
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import match_surface, position_deviation
from ur_nodes.slam.matching.scan import MapScan, make_scan

_NEAR = 0.05  # m
_LOOP = (1.0, 50.0)  # m: poses so near to each other after so long a way are a loop
_SAME_VIEW, _LEAST_POINTS = 1.2, 40  # rad, points: scans of a loop that can be matched,
_CLEAR, _CERTAIN = 0.7, 0.03  # agreement and m: clearly,
_AGREES = 0.1  # m: and so near to the reference that they confirm it


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


def relation_errors(path: Floats, log: Log, pairs: NDArray[np.intp] | None = None) -> tuple[Floats, Floats]:
    """The errors in m and degrees of relative poses of pairs (n, 2); as a default those of `loops_of`."""
    pairs = loops_of(log) if pairs is None else pairs
    pairs = pairs[np.isfinite(path[pairs, 0]).all(axis=1)]
    if not len(pairs):
        return np.zeros(0), np.zeros(0)
    found, true = (_relative(poses[pairs[:, 0]], poses[pairs[:, 1]]) for poses in (path, log.reference))
    turns = np.abs(np.remainder(found[:, 2] - true[:, 2] + math.pi, 2.0 * math.pi) - math.pi)
    return np.hypot(*(found[:, :2] - true[:, :2]).T), np.degrees(turns)


def loops_of(log: Log) -> NDArray[np.intp]:
    """The pairs (n, 2) of scans between which errors count: those of the log, or those found in its reference."""
    return find_loops(log.reference) if log.loops is None else log.loops


def confirmed_loops(log: Log) -> NDArray[np.intp]:
    """The pairs (n, 2) of `loops_of` whose two scans, matched directly, agree with the reference."""
    scans: dict[int, MapScan] = {}
    mount = SensorMount(np.eye(3), np.array((*log.mount[:2], 0.0)))
    pairs = loops_of(log)
    places = _relative(log.reference[pairs[:, 0]], log.reference[pairs[:, 1]])
    confirmed = np.zeros(len(pairs), dtype=bool)
    for index, (pair, place) in enumerate(zip(pairs.tolist(), places, strict=True)):
        guess = Pose2(place[0], place[1], wrap_angle(place[2]))
        if abs(guess.yaw) > _SAME_VIEW:
            continue
        for number in pair:
            if number not in scans:
                scans[number] = make_scan(log.ranges[number], log.directions, log.range_limits, mount)
        before, after = (scans[number] for number in pair)
        if min(len(before.surface), len(after.surface)) < _LEAST_POINTS:
            continue
        match = match_surface(LocalMap([(Pose2(0.0, 0.0, 0.0), before.surface)]), after.surface, guess)
        clear = match.agreement > _CLEAR and position_deviation(match.covariance) < _CERTAIN
        confirmed[index] = clear and math.dist(match.pose[:2], guess[:2]) < _AGREES
    return pairs[confirmed]


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
