"""Planar covariances (3, 3) of x, y, yaw, in the (6, 6) of messages: x, y, z and turns about them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ur_nodes.ports.values import NO_MATRIX

_PLANAR = (0, 1, 5)
_PLACES = [6 * row + column for row in _PLANAR for column in _PLANAR]
_NOTHING = [0.0] * 36


def numbers_of(matrix: NDArray[np.float64], others: float = 0.0) -> list[float]:
    """The 36 numbers of a message; `others` are the variances of height, roll and pitch."""
    if matrix is NO_MATRIX:
        return _NOTHING
    numbers = _NOTHING.copy()
    numbers[14] = numbers[21] = numbers[28] = others
    (numbers[0], numbers[1], numbers[5]), (numbers[6], numbers[7], numbers[11]), last = matrix.tolist()
    numbers[30], numbers[31], numbers[35] = last
    return numbers


def matrix_of(numbers: Sequence[float]) -> NDArray[np.float64]:
    """The matrix (3, 3) of a message."""
    return np.array([numbers[place] for place in _PLACES], dtype=np.float64).reshape(3, 3)
