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
from ur_nodes.slam.surface import Floats

_CELL = 0.05  # m
_SPREAD = 0.06  # m: a point that lies so far from a wall scores exp(-1/2)
_MARGIN = 0.3  # m round the walls
_LEVELS = 5
_WIDEST = 30000  # poses of a level; the least likely ones beyond are dropped
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
    """Distances to walls in cells of 0.05 m; each further level holds the best of 2 x 2 windows of the one before."""

    def __init__(self, walls: Floats) -> None:
        """From points (n, 2) on walls, m; at least one."""
        border = _MARGIN + _CELL * 2**_LEVELS
        self._low: Floats = walls.min(axis=0) - border
        size = np.ceil((walls.max(axis=0) + border - self._low) / _CELL).astype(int) + 1
        empty = np.ones((size[1], size[0]), dtype=bool)
        columns, rows = np.floor((walls - self._low) / _CELL).astype(np.intp).T
        empty[rows, columns] = False
        distances = distance_transform_edt(empty) * _CELL
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
        base = ((corner - self._low) / _CELL).astype(np.float32)
        cells = np.floor(turned[poses[:, 2]] + base).astype(np.int32)
        columns = np.clip(cells[..., 0] + poses[:, 0, None].astype(np.int32), 0, width - 1)
        rows = np.clip(cells[..., 1] + poses[:, 1, None].astype(np.int32), 0, height - 1)
        scores: NDArray[np.float32] = table.ravel().take(rows * width + columns).mean(axis=1)
        return scores


def search(pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, floor: float = 0.3) -> Found | None:
    """Find the pose with the best score in a window about a guess; None when none reaches `floor`.

    `points` (m, 2) are in the frame of the scan; a hundred or two suffice.
    """
    far = float(np.quantile(np.hypot(*points.T), 0.9)) if len(points) else 0.0
    step = _CELL / max(far, 1.0)
    turns = np.arange(-math.ceil(window.turn / step), math.ceil(window.turn / step) + 1) * step
    angles = guess.yaw + turns
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    turned = np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=-1)
    scaled = (turned / _CELL).astype(np.float32)
    reach = math.ceil(window.shift / _CELL)
    corner = np.array((guess.x, guess.y)) - reach * _CELL
    top = min(_LEVELS - 1, max(0, int(math.log2(max(1, 2 * reach))) - 1))
    side = np.arange(0, 2 * reach + 1, 2**top)
    grids = np.meshgrid(side, side, np.arange(len(angles)), indexing="ij")
    poses = np.column_stack([each.ravel() for each in grids])
    bounds = pyramid.score(top, poses, scaled, corner)
    best = max(floor, _dive(pyramid, top, poses, bounds, scaled, corner))
    for level in range(top, 0, -1):
        poses = _expand(_likely(poses, bounds, _KEPT * best), level)
        bounds = pyramid.score(level - 1, poses, scaled, corner)
    if not len(poses) or float(bounds.max()) < floor:
        return None
    winner = int(np.argmax(bounds))
    apart = np.hypot(*(poses[:, :2] - poses[winner, :2]).T) * _CELL > _APART[0]
    apart |= np.abs(poses[:, 2] - poses[winner, 2]) * step > _APART[1]
    column, row, turn = poses[winner]
    return Found(
        Pose2(float(corner[0] + column * _CELL), float(corner[1] + row * _CELL), wrap_angle(float(angles[turn]))),
        float(bounds[winner]),
        float(bounds[apart].max()) if apart.any() else 0.0,
    )


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


def _likely(poses: NDArray[np.intp], bounds: NDArray[np.float32], least: float) -> NDArray[np.intp]:
    kept = np.flatnonzero(bounds >= least)
    if len(kept) > _WIDEST // 4:
        kept = kept[np.argpartition(bounds[kept], -_WIDEST // 4)[-_WIDEST // 4 :]]
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
