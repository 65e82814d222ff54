"""Distances from marked cells up to a limit, with little memory: integers, a strip of the grid at a time."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

_STRIP = 1 << 18  # cells that are worked on at a time: what fits into the processor's cache


def squared_distances(marks: NDArray[np.bool_], reach: int) -> NDArray[np.uint16]:
    """Return squared distances in cells (height, width) to the nearest mark, exact up to `reach` cells (at most 180).

    Farther cells have some value above reach^2. First along columns, then along rows (Saito and Toriwaki, 1994).
    """
    far = reach + 1
    along = np.where(marks, np.uint8(0), np.uint8(far)).astype(np.uint8)
    for row in range(1, len(along)):
        np.minimum(along[row], along[row - 1] + np.uint8(1), out=along[row])
    for row in range(len(along) - 2, -1, -1):
        np.minimum(along[row], along[row + 1] + np.uint8(1), out=along[row])
    squares = along.astype(np.uint16)
    squares *= squares
    result: NDArray[np.uint16] = squares.copy()
    width = marks.shape[1]
    shifted = np.empty_like(squares)
    for step in range(1, min(reach, width - 1) + 1):
        np.add(squares, np.uint16(step * step), out=shifted)
        np.minimum(result[:, step:], shifted[:, :-step], out=result[:, step:])
        np.minimum(result[:, :-step], shifted[:, step:], out=result[:, :-step])
    return result


def strips(shape: tuple[int, int], margin: int) -> Iterator[tuple[slice, slice, slice]]:
    """Cut a grid into strips of rows: (rows of a strip, those with `margin` more on each side, the first in these)."""
    height, width = shape
    rows = max(1, margin, math.ceil(_STRIP / max(1, width)))
    for start in range(0, height, rows):
        stop = min(height, start + rows)
        low, high = max(0, start - margin), min(height, stop + margin)
        yield slice(start, stop), slice(low, high), slice(start - low, stop - low)
