"""A calibration in progress: the choice of views among pictures, and texts about it. Pure but for OpenCV's corners."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ur_nodes.camera.calibration.board import Board, Floats, find_corners
from ur_nodes.pictures.decode import Pixels

CELLS = (4, 3)  # columns and rows into which the picture is divided
ENOUGH_VIEWS = 15
_TILTED = 0.07  # logarithm of the ratio of two opposite edges of the board
_FACES = ("left", "right", "top", "bottom")  # the edge of the board that is farther away
_NOVEL = 0.12
_STILL = 0.004  # of the picture's width, from one picture to the next


@dataclass(frozen=True, slots=True)
class BoardView:
    """Corners of the board in one picture (rows * columns, 2), and the size of the picture in pixels."""

    corners: Floats
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class Coverage:
    """Progress: cells of the picture (column, row) without corners, tilts that are missing, and the number of views."""

    missing_cells: frozenset[tuple[int, int]]
    missing_tilts: tuple[str, ...]
    views: int

    @property
    def is_complete(self) -> bool:
        """Return whether the views suffice."""
        return not self.missing_cells and not self.missing_tilts and self.views >= ENOUGH_VIEWS

    @property
    def share(self) -> float:
        """Return the progress from 0.0 to 1.0."""
        have = CELLS[0] * CELLS[1] - len(self.missing_cells) + len(_FACES) - len(self.missing_tilts)
        whole = CELLS[0] * CELLS[1] + len(_FACES) + ENOUGH_VIEWS
        return (have + min(self.views, ENOUGH_VIEWS)) / whole


def measure_coverage(views: Sequence[BoardView], board: Board) -> Coverage:
    """Compare views with what a calibration needs: corners all over the picture, and the board tilted each way."""
    cells = {(column, row) for column in range(CELLS[0]) for row in range(CELLS[1])}
    tilts = dict.fromkeys(_FACES)
    for view in views:
        x = np.clip(view.corners[:, 0] * CELLS[0] / view.width, 0, CELLS[0] - 1).astype(int)
        y = np.clip(view.corners[:, 1] * CELLS[1] / view.height, 0, CELLS[1] - 1).astype(int)
        cells -= set(zip(x.tolist(), y.tolist(), strict=True))
        for face in list_tilts(view, board):
            tilts.pop(face, None)
    return Coverage(frozenset(cells), tuple(tilts), len(views))


def list_tilts(view: BoardView, board: Board) -> tuple[str, ...]:
    """The edges of the board, as the picture shows it, that are farther away than the opposite ones."""
    top_left, top_right, bottom_right, bottom_left = _outline(view, board)
    across = _log_ratio(top_right - bottom_right, top_left - bottom_left)  # > 0: the right edge is nearer
    along = _log_ratio(bottom_right - bottom_left, top_right - top_left)
    found = []
    if abs(across) > _TILTED:
        found.append("left" if across > 0.0 else "right")
    if abs(along) > _TILTED:
        found.append("top" if along > 0.0 else "bottom")
    return tuple(found)


def is_novel(view: BoardView, views: Sequence[BoardView], board: Board) -> bool:
    """Return whether a view differs enough from all earlier ones."""
    own = _features(view, board)
    return all(float(np.abs(own - _features(each, board)).max()) > _NOVEL for each in views)


def is_still(view: BoardView, before: BoardView | None) -> bool:
    """Return whether the board has not moved since the last picture, so that this one is not blurred."""
    if before is None or before.corners.shape != view.corners.shape:
        return False
    return float(np.abs(view.corners - before.corners).max()) < _STILL * view.width


def advise(coverage: Coverage) -> str:
    """Return advice where to hold the board next; '' when the views suffice."""
    if coverage.missing_cells:
        column, row = min(coverage.missing_cells, key=lambda cell: (cell[1], cell[0]))
        across = ("left", "left of the middle", "right of the middle", "right")[column]
        return f"hold the board at the {('top', 'middle', 'bottom')[row]} {across} of the picture"
    if coverage.missing_tilts:
        return f"tilt the board: its {coverage.missing_tilts[0]} edge away from the camera"
    if coverage.views < ENOUGH_VIEWS:
        return f"{ENOUGH_VIEWS - coverage.views} more views: nearer, farther, turned"
    return ""


def _outline(view: BoardView, board: Board) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the outer corners clockwise from the top left one of the picture, however the board is turned."""
    grid = view.corners.reshape(board.rows, board.columns, 2)
    ring = [grid[0, 0], grid[0, -1], grid[-1, -1], grid[-1, 0]]
    first = min(range(4), key=lambda n: float(ring[n].sum()))
    ring = ring[first:] + ring[:first]
    side, next_side = ring[1] - ring[0], ring[3] - ring[0]
    if side[0] * next_side[1] - side[1] * next_side[0] < 0.0:
        ring = [ring[0], ring[3], ring[2], ring[1]]
    return ring[0], ring[1], ring[2], ring[3]


def _log_ratio(one: Floats, other: Floats) -> float:
    return math.log(max(float(np.linalg.norm(one)), 1e-6) / max(float(np.linalg.norm(other)), 1e-6))


def _features(view: BoardView, board: Board) -> Floats:
    """Return position, size and tilt of the board, each between about 0 and 1."""
    a, b, c, d = _outline(view, board)
    centre = (a + b + c + d) / 4.0
    side = abs((c - a)[0] * (d - b)[1] - (c - a)[1] * (d - b)[0]) / 2.0
    return np.array(
        [
            centre[0] / view.width,
            centre[1] / view.height,
            math.sqrt(side / (view.width * view.height)),
            _log_ratio(b - c, a - d),
            _log_ratio(c - d, b - a),
        ]
    )


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
