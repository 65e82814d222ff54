"""A printed chessboard: its page, and its corners in pictures."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
_PAGE = (297.0, 210.0)  # mm: A4


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


def draw_page(board: Board) -> str:
    """Draw the board as SVG in its true size, on a page of A4."""
    edge = board.square * 1000.0
    left, top = (_PAGE[0] - (board.columns + 1) * edge) / 2.0, (_PAGE[1] - (board.rows + 1) * edge) / 2.0
    squares = "".join(
        f'<rect x="{left + column * edge:g}" y="{top + row * edge:g}" width="{edge:g}" height="{edge:g}"/>'
        for row in range(board.rows + 1)
        for column in range(board.columns + 1)
        if (row + column) % 2 == 0
    )
    text = f"{board.columns} x {board.rows} inner corners, squares of {edge:g} mm; print it on A4 without scaling"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_PAGE[0]:g}mm" height="{_PAGE[1]:g}mm"'
        f' viewBox="0 0 {_PAGE[0]:g} {_PAGE[1]:g}">'
        f'<rect width="{_PAGE[0]:g}" height="{_PAGE[1]:g}" fill="white"/>{squares}'
        f'<text x="{left:g}" y="{_PAGE[1] - 6:g}" font-family="sans-serif" font-size="5">{text}</text></svg>\n'
    )
