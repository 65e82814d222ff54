"""A calibration in progress: the choice of views among pictures, and texts about it. Pure but for OpenCV's corners."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ur_nodes.camera.calibration.board import Board, find_corners
from ur_nodes.camera.calibration.coverage import (
    CELLS,
    ENOUGH_VIEWS,
    BoardView,
    Coverage,
    advise,
    is_novel,
    is_still,
    measure_coverage,
)
from ur_nodes.pictures.decode import Pixels

_GREEN, _RED, _YELLOW = (60, 200, 90), (200, 50, 50), (240, 220, 60)
MOST_VIEWS = 60


@dataclass(slots=True)
class CalibrationSession:
    """The views so far. `look` takes a picture; a picture of another size discards them."""

    board: Board
    views: list[BoardView] = field(default_factory=list)
    last: BoardView | None = None
    event: str = "show the board to the camera"

    @property
    def coverage(self) -> Coverage:
        """The coverage of the views so far."""
        return measure_coverage(self.views, self.board)

    def look(self, pixels: Pixels) -> None:
        """Search a picture for the board, and keep the view if it is new and the board does not move."""
        height, width = pixels.shape[:2]
        if self.views and (self.views[0].width, self.views[0].height) != (width, height):
            self.views, self.last = [], None
        grey = np.ascontiguousarray(pixels.mean(axis=2).astype(np.uint8))
        corners = find_corners(grey, self.board)
        if corners is None:
            self.last, self.event = None, f"no board of {self.board.columns} x {self.board.rows} inner corners is seen"
            return
        view = BoardView(corners, width, height)
        if not is_still(view, self.last):
            self.event = "hold the board still"
        elif not is_novel(view, self.views, self.board) or len(self.views) >= MOST_VIEWS:
            self.event = "this view is known"
        else:
            self.views.append(view)
            self.event = f"view {len(self.views)} is taken"
        self.last = view


def describe(session: CalibrationSession) -> str:
    """Describe progress and advice in one line."""
    return f"{describe_progress(session)}   {advise(session.coverage) or 'complete'}"


def describe_progress(session: CalibrationSession) -> str:
    """Describe the progress, the number of views, and the result of the last picture."""
    coverage = session.coverage
    return f"{100 * coverage.share:3.0f} %   {coverage.views} of {ENOUGH_VIEWS} views   {session.event}"


def draw_overlay(pixels: Pixels, session: CalibrationSession) -> Pixels:
    """Draw the coverage into the picture: cells without corners in red, the others in green, and the found corners."""
    height, width = pixels.shape[:2]
    drawn = pixels.astype(np.int16)
    missing = session.coverage.missing_cells
    for column in range(CELLS[0]):
        for row in range(CELLS[1]):
            top, bottom = row * height // CELLS[1], (row + 1) * height // CELLS[1]
            left, right = column * width // CELLS[0], (column + 1) * width // CELLS[0]
            colour = np.array(_RED if (column, row) in missing else _GREEN, np.int16)
            drawn[top:bottom, left:right] = (3 * drawn[top:bottom, left:right] + colour) // 4
    shown: npt.NDArray[np.uint8] = np.clip(drawn, 0, 255).astype(np.uint8)
    if session.last is not None and (session.last.width, session.last.height) == (width, height):
        radius = max(1, width // 120)
        for x, y in session.last.corners.round().astype(int).tolist():
            shown[max(0, y - radius) : y + radius + 1, max(0, x - radius) : x + radius + 1] = _YELLOW
    return shown
