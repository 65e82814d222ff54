"""Cover the occupied cells of a grid with few rectangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Rectangle(NamedTuple):
    """Cells from (`column`, `row`), `width` by `height` of them."""

    column: int
    row: int
    width: int
    height: int


def merge_cells(occupied: npt.NDArray[np.bool_]) -> tuple[Rectangle, ...]:
    """Rectangles that together cover each occupied cell exactly once and no other.

    Greedy: from each uncovered cell in reading order the larger of the widest and the tallest rectangle. Not the
    fewest possible, but near it for floor plans, in time linear in the cells.
    """
    left = occupied.copy()
    found: list[Rectangle] = []
    for row, column in zip(*np.nonzero(occupied), strict=True):
        if left[row, column]:
            part = left[row:, column:]
            wide, tall = _grow(part), _grow(part.T)
            width, height = wide if wide[0] * wide[1] >= tall[0] * tall[1] else (tall[1], tall[0])
            part[:height, :width] = False
            found.append(Rectangle(int(column), int(row), width, height))
    return tuple(found)


def _grow(part: npt.NDArray[np.bool_]) -> tuple[int, int]:
    """Width of the run at the start of the first row, and in how many rows it goes on."""
    width = _run(part[0, :])
    return width, _run(part[:, :width].all(axis=1))


def _run(line: npt.NDArray[np.bool_] | np.bool_) -> int:
    """Count the cells that are set before the first that is not."""
    return int(line.size if line.all() else np.argmin(line))
