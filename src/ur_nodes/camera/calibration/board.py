"""A printed chessboard, and its corners in pictures."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Board:
    """A chessboard by its inner corners, where four squares meet; `square` is the edge of one in m."""

    columns: int = 8
    rows: int = 6
    square: float = 0.025

    @property
    def points(self) -> Floats:
        """Its corners on the board, (rows * columns, 3) in m, row by row."""
        grid = np.zeros((self.rows, self.columns, 3))
        grid[:, :, 0], grid[:, :, 1] = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        flat: Floats = grid.reshape(-1, 3) * self.square
        return flat


def find_corners(grey: npt.NDArray[np.uint8], board: Board) -> Floats | None:
    """Find the board's corners in a grey picture, (rows * columns, 2) in pixels; None if any is not visible."""
    import cv2

    found: object
    seen, found = cv2.findChessboardCornersSB(grey, (board.columns, board.rows), flags=cv2.CALIB_CB_NORMALIZE_IMAGE)
    return np.asarray(found, np.float64).reshape(-1, 2) if seen else None
