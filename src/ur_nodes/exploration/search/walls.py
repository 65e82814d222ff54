"""Straight walls, continued through the unknown space where they end in it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from ur_nodes.exploration.search.floor import Floor

_AROUND = 0.4  # m: cells of a wall so near, along either axis, tell its direction
_FEWEST = 5  # cells of a wall whose direction is known
_STRAIGHT = 0.1  # variance across a wall, as a share of that along it, at most
_AT_END = 0.3  # of `_AROUND`: how far the middle of the cells near an end lies away from it, at least
CONTINUED = 2.0
"""The length (m) by which a wall is continued."""


def continue_walls(floor: Floor, length: float = CONTINUED) -> NDArray[np.bool_]:
    """Unknown cells (height, width) that a straight wall runs into: there is probably a wall, too.

    A wall is continued by at most `length` m, and never beyond known floor. Corners and round things are not.
    """
    continued = np.zeros(floor.shape, bool)
    starts, directions = _ends(floor)
    if not len(starts):
        return continued
    steps = np.arange(1, math.ceil(length / floor.resolution) + 1)
    cells = np.rint(starts[:, None] + steps[:, None] * directions[:, None]).astype(np.intp)
    height, width = floor.shape
    inside = ((cells >= 0) & (cells < (height, width))).all(axis=-1)
    rows, columns = np.clip(cells[..., 0], 0, height - 1), np.clip(cells[..., 1], 0, width - 1)
    passed = np.logical_and.accumulate(inside & ~floor.free[rows, columns], axis=1)
    passed &= floor.unknown[rows, columns]
    continued[rows[passed], columns[passed]] = True
    return continued


def _ends(floor: Floor) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The cells (n, 2) at ends of straight walls, and unit vectors (n, 2) in cells that lead on from there."""
    cells = np.argwhere(floor.occupied)
    if not len(cells):
        return cells, np.zeros((0, 2))
    side = 2 * max(2, round(_AROUND / floor.resolution)) + 1
    wall = floor.occupied.astype(np.float64)
    row, column = np.indices(floor.shape, dtype=np.float64)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        sums = uniform_filter(values * wall, side, mode="constant")[floor.occupied]
        means: NDArray[np.float64] = sums / shares
        return means

    shares = uniform_filter(wall, side, mode="constant")[floor.occupied]
    middle = np.column_stack((mean(row), mean(column)))
    rows = mean(row * row) - middle[:, 0] ** 2
    columns = mean(column * column) - middle[:, 1] ** 2
    mixed = mean(row * column) - middle[:, 0] * middle[:, 1]
    spread = np.hypot(rows - columns, 2.0 * mixed)
    along, across = 0.5 * (rows + columns + spread), 0.5 * (rows + columns - spread)
    angle = 0.5 * np.arctan2(2.0 * mixed, columns - rows)  # from the columns' axis
    directions = np.column_stack((np.sin(angle), np.cos(angle)))
    lead = ((cells - middle) * directions).sum(axis=1)
    end = (shares * side**2 > _FEWEST - 0.5) & (across <= _STRAIGHT * along)
    end &= np.abs(lead) >= _AT_END * (side // 2)
    return cells[end], directions[end] * np.sign(lead[end])[:, None]
