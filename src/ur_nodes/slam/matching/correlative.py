"""Find a scan on a map without a good guess: all poses of a window, from coarse to fine, and none left out.

Sources: Olson, Real-time correlative scan matching, 2009; Hess et al., Real-time loop closure in 2D lidar SLAM, 2016
(branch and bound). The bounds are those of the latter; all poses of a level are scored at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.surface import Floats

_CELL = 0.05  # m
_SPREAD = 1.2  # cells: a point that lies so far from a wall scores exp(-1/2)
_MARGIN = 6  # cells round the walls
_LEVELS = 5
_WIDEST = 30000  # poses of a level; the least likely ones beyond are dropped
_TOP_OF_PLACES, _WIDEST_OF_PLACES = 2, 120000  # likewise for a window that holds many rooms
_BLOCK = 2048  # poses that are scored at a time, for the sake of memory
_DIVE = 24  # poses that are followed down first, for a score to hold the others against
_KEPT = 0.8  # of the best score: poses that are followed up, for the sake of rivals
_APART = (0.6, 0.25)  # m, rad: farther from the best pose, another one is a different place


@dataclass(frozen=True, slots=True)
class Window:
    """Search range (m, rad) around the initial guess."""

    shift: float
    turn: float


@dataclass(frozen=True, slots=True)
class Found:
    """The best pose, its score, and the best score of another place (each 0..1: 1 when all points lie on walls)."""

    pose: Pose2
    score: float
    rival: float


class Pyramid:
    """Distances to walls in cells of `cell` m; each further level holds the best of 2 x 2 windows of the one before."""

    def __init__(self, walls: Floats, cell: float = _CELL) -> None:
        """From points (n, 2) on walls, m; at least one."""
        self.cell = cell
        border = cell * (_MARGIN + 2**_LEVELS)
        self._low: Floats = walls.min(axis=0) - border
        size = np.ceil((walls.max(axis=0) + border - self._low) / cell).astype(int) + 1
        empty = np.ones((size[1], size[0]), dtype=bool)
        columns, rows = np.floor((walls - self._low) / cell).astype(np.intp).T
        empty[rows, columns] = False
        distances = distance_transform_edt(empty)
        level = np.exp(-0.5 * np.square(distances / _SPREAD)).astype(np.float32)
        self.levels = [level]
        for number in range(_LEVELS - 1):
            level = _best_of_windows(level, 2**number)
            self.levels.append(level)

    def score(
        self, level: int, poses: NDArray[np.intp], turned: NDArray[np.float32], corner: Floats
    ) -> NDArray[np.float32]:
        """The scores (n) of poses (n, 3) as column, row and number of a turn; at higher levels upper bounds.

        `turned` (turns, m, 2) are the points in cells, turned; `corner` (2) is where pose 0, 0 lies, m.
        """
        if len(poses) > _BLOCK:
            parts = [poses[first : first + _BLOCK] for first in range(0, len(poses), _BLOCK)]
            return np.concatenate([self.score(level, part, turned, corner) for part in parts])
        table = self.levels[level]
        height, width = table.shape
        base = ((corner - self._low) / self.cell).astype(np.float32)
        cells = np.floor(turned[poses[:, 2]] + base).astype(np.int32)
        columns = np.clip(cells[..., 0] + poses[:, 0, None].astype(np.int32), 0, width - 1)
        rows = np.clip(cells[..., 1] + poses[:, 1, None].astype(np.int32), 0, height - 1)
        scores: NDArray[np.float32] = table.ravel().take(rows * width + columns).mean(axis=1)
        return scores


@dataclass(frozen=True, slots=True, eq=False)
class _Ranked:
    """Poses (n, 3) of a window as column, row and number of a turn, with their scores (n).

    `corner` (2) is where column and row 0 lie, m; `angles` are the turns, `step` rad apart.
    """

    poses: NDArray[np.intp]
    scores: NDArray[np.float32]
    corner: Floats
    angles: Floats
    step: float
    cell: float

    def pose(self, number: int) -> Pose2:
        column, row, turn = self.poses[number]
        place = self.corner + self.cell * np.array((column, row))
        return Pose2(float(place[0]), float(place[1]), wrap_angle(float(self.angles[turn])))

    def apart(self, number: int) -> NDArray[np.bool_]:
        """Tell for each pose (n) whether it is a place other than that of pose `number`."""
        shift = np.hypot(*(self.poses[:, :2] - self.poses[number, :2]).T) * self.cell
        swing = np.remainder(np.abs(self.poses[:, 2] - self.poses[number, 2]) * self.step, 2.0 * math.pi)
        found: NDArray[np.bool_] = (shift > _APART[0]) | (np.minimum(swing, 2.0 * math.pi - swing) > _APART[1])
        return found


def search(pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, floor: float = 0.3) -> Found | None:
    """Find the pose with the best score in a window about a guess; None when none reaches `floor`.

    `points` (m, 2) are in the frame of the scan; a hundred or two suffice.
    """
    ranked = _rank(pyramid, points, guess, window, floor)
    if not len(ranked.scores) or float(ranked.scores.max()) < floor:
        return None
    winner = int(np.argmax(ranked.scores))
    apart = ranked.apart(winner)
    rival = float(ranked.scores[apart].max()) if apart.any() else 0.0
    return Found(ranked.pose(winner), float(ranked.scores[winner]), rival)


def search_places(
    pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, most: int, floor: float = 0.3
) -> list[tuple[Pose2, float]]:
    """Find up to `most` places with the best scores in a window about a guess: pose and score, the best first.

    Scores below 0.8 of the best one are left out. `points` as for `search`.
    """
    ranked = _rank(pyramid, points, guess, window, floor, _TOP_OF_PLACES, _WIDEST_OF_PLACES)
    left = ranked.scores >= floor
    found: list[tuple[Pose2, float]] = []
    while len(found) < most and left.any():
        winner = int(np.argmax(np.where(left, ranked.scores, -1.0)))
        found.append((ranked.pose(winner), float(ranked.scores[winner])))
        left &= ranked.apart(winner)
    return found


def _rank(
    pyramid: Pyramid,
    points: Floats,
    guess: Pose2,
    window: Window,
    floor: float,
    top: int = _LEVELS - 1,
    widest: int = _WIDEST,
) -> _Ranked:
    """Score the poses of a window that may reach `floor` and 0.8 of the best score; `top` is the first level."""
    cell = pyramid.cell
    far = float(np.quantile(np.hypot(*points.T), 0.9)) if len(points) else 0.0
    step = cell / max(far, 20.0 * cell)
    turns = np.arange(-math.ceil(window.turn / step), math.ceil(window.turn / step) + 1) * step
    angles = np.asarray(guess.yaw + turns, np.float64)
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    turned = np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=-1)
    scaled = (turned / cell).astype(np.float32)
    reach = math.ceil(window.shift / cell)
    corner = np.array((guess.x, guess.y)) - reach * cell
    top = min(top, max(0, int(math.log2(max(1, 2 * reach))) - 1))
    side = np.arange(0, 2 * reach + 1, 2**top)
    grids = np.meshgrid(side, side, np.arange(len(angles)), indexing="ij")
    poses = np.column_stack([each.ravel() for each in grids])
    bounds = pyramid.score(top, poses, scaled, corner)
    best = max(floor, _dive(pyramid, top, poses, bounds, scaled, corner))
    for level in range(top, 0, -1):
        poses = _expand(_likely(poses, bounds, _KEPT * best, widest // 4), level)
        bounds = pyramid.score(level - 1, poses, scaled, corner)
    return _Ranked(poses, bounds, corner, angles, step, cell)


def _dive(
    pyramid: Pyramid,
    top: int,
    poses: NDArray[np.intp],
    bounds: NDArray[np.float32],
    turned: NDArray[np.float32],
    corner: Floats,
) -> float:
    """A score that is reached: the best below the most promising poses."""
    for level in range(top, 0, -1):
        first = np.argsort(bounds)[-_DIVE:]
        poses = _expand(poses[first], level)
        bounds = pyramid.score(level - 1, poses, turned, corner)
    return float(bounds.max())


def _likely(poses: NDArray[np.intp], bounds: NDArray[np.float32], least: float, most: int) -> NDArray[np.intp]:
    kept = np.flatnonzero(bounds >= least)
    if len(kept) > most:
        kept = kept[np.argpartition(bounds[kept], -most)[-most:]]
    return poses[kept]


def _expand(poses: NDArray[np.intp], level: int) -> NDArray[np.intp]:
    half = 2 ** (level - 1)
    corners = np.array(((0, 0, 0), (half, 0, 0), (0, half, 0), (half, half, 0)))
    expanded: NDArray[np.intp] = (poses[:, None] + corners).reshape(-1, 3)
    return expanded


def _best_of_windows(level: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """For each cell the best of itself and those `step` to the right, above and both."""
    best: NDArray[np.float32] = level.copy()
    np.maximum(best[:, :-step], level[:, step:], out=best[:, :-step])
    right = best.copy()
    np.maximum(best[:-step], right[step:], out=best[:-step])
    return best
