from pathlib import Path

import numpy as np
import pytest

from ur_nodes.camera.calibration.board import Board, Floats
from ur_nodes.camera.calibration.session import (
    CELLS,
    BoardView,
    Coverage,
    advise,
    is_novel,
    is_still,
    list_tilts,
    measure_coverage,
)
from ur_nodes.teleop.camera.picture_screen import draw_picture_screen

BOARD = Board(5, 4)


def make_view(x: float = 320.0, y: float = 240.0, size: float = 200.0, narrow: str = "") -> BoardView:
    """A board in the picture whose edge `narrow` is shorter than the opposite one."""
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, BOARD.columns), np.linspace(-0.4, 0.4, BOARD.rows))
    shrink = {"left": 1 + 0.3 * u, "right": 1 - 0.3 * u, "top": 1 + 0.3 * v, "bottom": 1 - 0.3 * v}.get(narrow, 1.0)
    across, along = (u * shrink, v) if narrow in ("top", "bottom") else (u, v * shrink)
    corners: Floats = np.stack([x + size * across, y + size * along], axis=-1).reshape(-1, 2)
    return BoardView(corners, 640, 480)


def test_without_views_everything_is_missing() -> None:
    coverage = measure_coverage([], BOARD)
    assert len(coverage.missing_cells) == 12
    assert coverage.share == 0.0
    assert advise(coverage) == "hold the board at the top left of the picture"


def test_cells_are_covered_where_corners_are() -> None:
    coverage = measure_coverage([make_view(60.0, 60.0, 80.0)], BOARD)
    assert (0, 0) not in coverage.missing_cells
    assert len(coverage.missing_cells) == 11
    assert "left of the middle" in advise(coverage)


@pytest.mark.parametrize("edge", ["left", "right", "top", "bottom"])
@pytest.mark.parametrize("turned", [False, True])
def test_edge_that_is_farther_away_is_recognised_however_the_board_is_turned(edge: str, turned: bool) -> None:
    view = make_view(narrow=edge)
    assert list_tilts(BoardView(view.corners[::-1] if turned else view.corners, 640, 480), BOARD) == (edge,)
    assert list_tilts(make_view(), BOARD) == ()


def test_view_is_new_when_it_is_elsewhere_or_tilted() -> None:
    view = make_view()
    assert not is_novel(make_view(325.0), [view], BOARD)
    assert is_novel(make_view(500.0), [view], BOARD)
    assert is_novel(make_view(narrow="left"), [view], BOARD)
    assert is_novel(make_view(size=320.0), [view], BOARD)


def test_board_is_still_when_its_corners_stay() -> None:
    assert is_still(make_view(), make_view(321.0))
    assert not is_still(make_view(), make_view(330.0))
    assert not is_still(make_view(), None)


def test_advice_goes_from_places_to_tilts_to_more_views() -> None:
    everywhere = [make_view(x, y, 240.0) for x in (130, 320, 510) for y in (100, 240, 380)]
    coverage = measure_coverage(everywhere, BOARD)
    assert advise(coverage) == "tilt the board: its left edge away from the camera"
    tilted = [*everywhere, *(make_view(narrow=edge) for edge in ("left", "right", "top", "bottom"))]
    assert advise(measure_coverage(tilted, BOARD)).startswith("2 more views")
    done = measure_coverage([*tilted, make_view(), make_view()], BOARD)
    assert done.is_complete
    assert advise(done) == ""
    assert done.share == 1.0


PAGE = (297.0, 210.0)  # mm: A4


def draw_page(board: Board) -> str:
    """Draw the board as SVG in its true size, on a page of A4."""
    edge = board.square * 1000.0
    left, top = (PAGE[0] - (board.columns + 1) * edge) / 2.0, (PAGE[1] - (board.rows + 1) * edge) / 2.0
    squares = "".join(
        f'<rect x="{left + column * edge:g}" y="{top + row * edge:g}" width="{edge:g}" height="{edge:g}"/>'
        for row in range(board.rows + 1)
        for column in range(board.columns + 1)
        if (row + column) % 2 == 0
    )
    text = f"{board.columns} x {board.rows} inner corners, squares of {edge:g} mm; print it on A4 without scaling"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{PAGE[0]:g}mm" height="{PAGE[1]:g}mm"'
        f' viewBox="0 0 {PAGE[0]:g} {PAGE[1]:g}">'
        f'<rect width="{PAGE[0]:g}" height="{PAGE[1]:g}" fill="white"/>{squares}'
        f'<text x="{left:g}" y="{PAGE[1] - 6:g}" font-family="sans-serif" font-size="5">{text}</text></svg>\n'
    )


def test_page_has_a_square_for_each_second_field_in_its_true_size() -> None:
    page = draw_page(Board())
    assert page.count("<rect") == 1 + 32
    assert 'width="297mm" height="210mm"' in page
    assert 'width="25" height="25"' in page


def test_printed_page_of_the_launch_library_is_the_default_board() -> None:
    page = Path(__file__).parents[4] / "ubiquity_launches" / "n_calibrate_camera" / "chessboard.svg"
    assert page.read_text() == draw_page(Board())


def test_advice_fits_beside_its_key_on_a_terminal_of_80_columns() -> None:
    cells = [Coverage(frozenset({(column, row)}), (), 3) for column in range(CELLS[0]) for row in range(CELLS[1])]
    tilts = [Coverage(frozenset(), (face,), 3) for face in ("left", "right", "top", "bottom")]
    for coverage in (*cells, *tilts, Coverage(frozenset(), (), 3)):
        advice = advise(coverage)
        (line, _) = draw_picture_screen(None, "", 80, 3, rich=False, advice=(advice, "c calibrates"))[1:]
        assert f" {advice} " in line
