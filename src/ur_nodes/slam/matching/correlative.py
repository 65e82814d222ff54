"""Exhaustive search for a scan on a map without a good guess: all poses of a window, from coarse to fine.

Sources: Olson, Real-time correlative scan matching, 2009; Hess et al., Real-time loop closure in 2D lidar SLAM, 2016
(branch and bound). The bounds are those of the latter, for blocks of turns as well as of shifts; all blocks of a level
are scored at once.
"""

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.surface import Floats

_CELL = 0.05  # m
_SPREAD = 1.2  # cells: a point that lies so far from a wall scores exp(-1/2)
_REACH = 5  # cells from a wall beyond which a point scores nothing
_LEVELS = 5
_SWING = (0, 0, 1, 2, 4)  # cells at each level that points may move while a block is turned
_MOST_TURNS = (1, 1, 2, 4, 8)  # turns of a block at each level
_WIDEST = 30000  # blocks of a level; the least likely ones beyond are dropped
_TOP_OF_PLACES, _WIDEST_OF_PLACES = 2, 120000  # likewise for a window that holds many rooms
_BATCH = 256  # blocks that are scored at a time, for the sake of caches
_UNIT = 4096  # blocks between two pauses
_DIVE = 24  # blocks that are followed down first, for a score to hold the others against
_KEPT = 0.8  # of the best score: blocks that are followed up, for the sake of rivals
_APART = (0.6, 0.25)  # m, rad: farther from the best pose, another one is a different place
_FULL = 200.0  # of a point on a wall, in the tables

T = TypeVar("T")
Work = Generator[int, None, T]
"""A computation in small parts: each `next` does one, and yields its cost as a number of blocks that were scored."""


@dataclass(frozen=True, slots=True)
class Window:
    """Search range (m, rad) around the initial guess."""

    shift: float
    turn: float


@dataclass(frozen=True, slots=True)
class CorrelativeMatch:
    """The best pose, its score, and the best score of another place (each 0..1: 1 when all points lie on walls)."""

    pose: Pose2
    score: float
    rival: float


class Pyramid:
    """Proximity to walls in cells of `cell` m; each further level is an upper bound for larger blocks."""

    def __init__(self, walls: Floats, cell: float = _CELL) -> None:
        """From points (n, 2) on walls, m."""
        self.cell = cell
        border = _REACH + 2**_LEVELS
        self.low: Floats = (walls if len(walls) else np.zeros((1, 2))).min(axis=0) - border * cell
        columns, rows = np.floor((walls - self.low) / cell).astype(np.intp).T
        width, height = int(columns.max(initial=0)) + border + 1, int(rows.max(initial=0)) + border + 1
        cells = rows * width + columns
        level = np.zeros(height * width, np.uint8)
        span = np.arange(-_REACH, _REACH + 1)
        squares = np.square(span)[:, None] + np.square(span)
        for number in np.argsort(squares, axis=None)[::-1].tolist():  # the nearest wall is written last
            row, column = divmod(number, len(span))
            value = round(_FULL * math.exp(-0.5 * squares[row, column] / _SPREAD**2))
            level[cells + (row - _REACH) * width + (column - _REACH)] = value
        windows = [level.reshape(height, width)]  # each holds for a cell the best of 2^k x 2^k cells from there on
        for number in range(_LEVELS - 1):
            windows.append(_best_of(windows[-1], 2**number))
        self.levels = [_widened(window, swing) for window, swing in zip(windows, _SWING, strict=True)]


class _Table:
    """Scores blocks of one level for the points of a scan: shifts of 2^level cells, and `turns` turns."""

    def __init__(self, pyramid: Pyramid, level: int, turned: Floats, cells: int, turns: int) -> None:
        """`turned` (blocks of turns, m, 2) are the points in cells of the pyramid, shifted by up to `cells`."""
        places = np.floor(turned).astype(np.intp)
        low = places.min(axis=(0, 1))
        width, height = (places.max(axis=(0, 1)) - low + cells + 1).tolist()
        values = np.zeros((height, width), np.uint8)
        known = pyramid.levels[level]
        (left, to_left), (below, to_below) = ((max(0, at), max(0, -at)) for at in low.tolist())
        part = known[below : below + max(0, height - to_below), left : left + max(0, width - to_left)]
        values[to_below : to_below + part.shape[0], to_left : to_left + part.shape[1]] = part
        self._values = values.ravel()
        self._width, self._turns = width, turns
        self._first = (places[..., 1] - low[1]) * width + (places[..., 0] - low[0])

    def score(self, blocks: NDArray[np.intp]) -> NDArray[np.float32]:
        """The scores (n) of blocks (n, 3) as column, row and number of the first turn: bounds of its poses' scores."""
        shifts = blocks[:, 1] * self._width + blocks[:, 0]
        groups = blocks[:, 2] // self._turns
        sums = np.empty(len(blocks), np.uint32)
        for first in range(0, len(blocks), _BATCH):
            part = slice(first, first + _BATCH)
            index = self._first[groups[part]]
            index += shifts[part, None]
            self._values.take(index).sum(axis=1, dtype=np.uint32, out=sums[part])
        scores: NDArray[np.float32] = sums.astype(np.float32) / np.float32(_FULL * max(1, self._first.shape[1]))
        return scores


class _Poses:
    """The poses of a window, as column, row and number of a turn, and the same in blocks at each level up to `top`."""

    def __init__(self, pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, top: int = _LEVELS - 1) -> None:
        cell = pyramid.cell
        lengths = np.hypot(*points.T)
        far = float(np.quantile(lengths, 0.9)) if len(points) else 0.0
        step = cell / max(far, 20.0 * cell)
        reach = math.ceil(window.shift / cell)
        top = min(top, max(0, int(math.log2(max(1, 2 * reach))) - 1))
        # The turns of a block at each level that no point leaves; a turn moves a point by up to `swing` cells
        swing = float(lengths.max(initial=0.0)) * step / cell
        turns = []
        for most, free in zip(_MOST_TURNS, _SWING, strict=True):
            while most > 1 and 0.5 * (most - 1) * swing > free:
                most //= 2
            turns.append(most)
        self._turns = turns[: top + 1]
        half = math.ceil(window.turn / step)
        count = -(-(2 * half + 1) // self._turns[top]) * self._turns[top]
        self._angles = np.asarray(guess.yaw + np.arange(-half, count - half) * step, np.float64)
        self._corner = np.array((guess.x, guess.y)) - reach * cell
        self._cell, self._step = cell, step
        side = np.arange(0, 2 * reach + 1, 2**top)
        self._tables = []
        for level, number in enumerate(self._turns):
            middle = self._angles[::number, None] + 0.5 * (number - 1) * step
            c, s = np.cos(middle), np.sin(middle)
            turned = np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]), axis=-1)
            turned += self._corner - pyramid.low
            self._tables.append(_Table(pyramid, level, turned / cell, int(side[-1]) + 2**top, number))
        grids = np.meshgrid(np.arange(0, count, self._turns[top]), side, side, indexing="ij")
        self._blocks = np.column_stack([each.ravel() for each in reversed(grids)])
        self._bounds = np.zeros(len(self._blocks), np.float32)

    def pose(self, place: NDArray[np.intp]) -> Pose2:
        """The pose (m, rad) with this column, row and number of a turn (3)."""
        x, y = (self._corner + self._cell * place[:2]).tolist()
        return Pose2(x, y, wrap_angle(float(self._angles[place[2]])))

    def apart(self, poses: NDArray[np.intp], place: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return for each pose (n, 3) whether it is at another place than a pose (3)."""
        shift = np.hypot(*(poses[:, :2] - place[:2]).T) * self._cell
        swing = np.remainder(np.abs(poses[:, 2] - place[2]) * self._step, 2.0 * math.pi)
        found: NDArray[np.bool_] = (shift > _APART[0]) | (np.minimum(swing, 2.0 * math.pi - swing) > _APART[1])
        return found

    def prepare(self) -> Work[None]:
        """Score the largest blocks; call it first."""
        self._bounds = yield from self._score(len(self._tables) - 1, self._blocks)

    def dive(self) -> float:
        """Return a score that is reached: the best below the most promising blocks."""
        blocks, bounds = self._blocks, self._bounds
        for level in range(len(self._tables) - 1, 0, -1):
            blocks = self._expand(blocks[np.argsort(bounds)[-_DIVE:]], level)
            bounds = self._tables[level - 1].score(blocks)
        return float(bounds.max())

    def above(
        self, least: float, widest: int = _WIDEST, other_than: NDArray[np.intp] | None = None
    ) -> Work[tuple[NDArray[np.intp], NDArray[np.float32]]]:
        """Return the poses (n, 3) with at least this score, and their scores (n); only at other places than a pose."""
        blocks, bounds = self._blocks, self._bounds
        for level in range(len(self._tables) - 1, -1, -1):
            kept = np.flatnonzero(bounds >= least)
            if other_than is not None:
                kept = kept[self._reaches_beyond(blocks[kept], level, other_than)]
            if level and len(kept) > widest // 4:
                kept = kept[np.argpartition(bounds[kept], -(widest // 4))[-(widest // 4) :]]
            blocks, bounds = blocks[kept], bounds[kept]
            if level:
                blocks = self._expand(blocks, level)
                bounds = yield from self._score(level - 1, blocks)
        return blocks, bounds

    def _score(self, level: int, blocks: NDArray[np.intp]) -> Work[NDArray[np.float32]]:
        parts = [np.zeros(0, np.float32)]
        for first in range(0, len(blocks), _UNIT):
            parts.append(self._tables[level].score(blocks[first : first + _UNIT]))
            yield len(parts[-1])
        return np.concatenate(parts)

    def _reaches_beyond(self, blocks: NDArray[np.intp], level: int, place: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return for each block (n, 3) whether some of its poses are a place other than that of a pose (3)."""
        ends = np.array((2**level, 2**level, self._turns[level])) - 1
        farthest = np.maximum(np.abs(blocks - place), np.abs(blocks + ends - place))
        return self.apart(farthest, np.zeros(3, np.intp))

    def _expand(self, blocks: NDArray[np.intp], level: int) -> NDArray[np.intp]:
        half, turns = 2 ** (level - 1), self._turns
        parts = [(x, y, t) for t in range(0, turns[level], turns[level - 1]) for x in (0, half) for y in (0, half)]
        expanded: NDArray[np.intp] = (blocks[:, None] + np.array(parts)).reshape(-1, 3)
        return expanded


def search(
    pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, floor: float = 0.3
) -> CorrelativeMatch | None:
    """Find the pose with the best score in a window about a guess; None when none reaches `floor`.

    `points` (m, 2) are in the frame of the scan; a hundred or two suffice. Rivals with less than 0.8 of the score
    count as none.
    """
    return finish(search_slowly(pyramid, points, guess, window, floor))


def search_slowly(
    pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, floor: float = 0.3
) -> Work[CorrelativeMatch | None]:
    """Search as `search` does, with pauses."""
    within = _Poses(pyramid, points, guess, window)
    yield from within.prepare()
    poses, scores = yield from within.above(max(floor, within.dive()))
    if not len(scores):
        return None
    winner, score = poses[int(np.argmax(scores))], float(scores.max())
    rivals = (yield from within.above(_KEPT * score, other_than=winner))[1]
    return CorrelativeMatch(within.pose(winner), score, float(rivals.max(initial=0.0)))


def finish(work: Work[T]) -> T:
    """Run all parts of a computation."""
    try:
        while True:
            next(work)
    except StopIteration as end:
        result: T = end.value
        return result


def search_poses(
    pyramid: Pyramid, points: Floats, guess: Pose2, window: Window, most: int, floor: float = 0.3
) -> list[tuple[Pose2, float]]:
    """Find up to `most` places with the best scores in a window about a guess: pose and score, the best first.

    Scores below 0.8 of the best one are left out. `points` as for `search`.
    """
    within = _Poses(pyramid, points, guess, window, _TOP_OF_PLACES)
    finish(within.prepare())
    best = max(floor, within.dive())
    poses, scores = finish(within.above(max(floor, _KEPT * best), _WIDEST_OF_PLACES))
    left = np.ones(len(scores), np.bool_)
    found: list[tuple[Pose2, float]] = []
    while len(found) < most and left.any():
        winner = int(np.argmax(np.where(left, scores, -1.0)))
        found.append((within.pose(poses[winner]), float(scores[winner])))
        left &= within.apart(poses, poses[winner])
    return found


def _best_of(level: NDArray[np.uint8], step: int) -> NDArray[np.uint8]:
    """Return for each cell the best of itself and the cells `step` to the right, above, and both."""
    best: NDArray[np.uint8] = level.copy()
    np.maximum(best[:, :-step], level[:, step:], out=best[:, :-step])
    right = best.copy()
    np.maximum(best[:-step], right[step:], out=best[:-step])
    return best


def _widened(level: NDArray[np.uint8], swing: int) -> NDArray[np.uint8]:
    """Return for each cell the best within `swing` to the four sides; windows at least twice as wide miss none."""
    if not swing:
        return level
    wide = np.zeros_like(level)
    wide[:, swing:-swing] = np.maximum(level[:, : -2 * swing], level[:, 2 * swing :])
    result = np.zeros_like(level)
    np.maximum(wide[: -2 * swing], wide[2 * swing :], out=result[swing:-swing])
    return result
