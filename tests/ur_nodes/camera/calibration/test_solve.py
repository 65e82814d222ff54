import numpy as np
import pytest
from tests.ur_nodes.camera.calibration.rendered_board import MATRIX, Studio, list_poses, project_views

from ur.source.diagnostic import UserError
from ur_nodes.camera.calibration.board import Board, find_corners
from ur_nodes.camera.calibration.session import BoardView, CalibrationSession, describe, draw_overlay, measure_coverage
from ur_nodes.camera.calibration.solve import CalibrationResult, solve, solve_or_fail

BOARD = Board()
VIEWS = project_views(BOARD)


def assert_good(result: CalibrationResult | None) -> None:
    """Within 1 % of the true calibration."""
    assert result is not None
    matrix = np.reshape(result.calibration.matrix, (3, 3))
    assert matrix[0, 0] == pytest.approx(MATRIX[0, 0], rel=0.01)
    assert matrix[1, 1] == pytest.approx(MATRIX[1, 1], rel=0.01)
    assert np.abs(matrix[:2, 2] - MATRIX[:2, 2]).max() < 0.01 * 640
    assert result.error < 0.3
    assert result.problem == ""
    assert (result.calibration.width, result.calibration.height) == (640, 480)


def test_calibration_is_found_within_one_percent() -> None:
    assert_good(solve(VIEWS, BOARD))


@pytest.mark.timeout(400)
def test_calibration_of_rendered_pictures_is_found_within_one_percent() -> None:
    studio, session = Studio(BOARD), CalibrationSession(BOARD)
    for rotation, translation in list_poses():
        picture = studio.take(rotation, translation)
        session.look(picture)
        session.look(picture)  # the board is held still
    assert session.coverage.missing_cells == frozenset()
    assert session.coverage.missing_tilts == ()
    assert_good(solve(session.views, BOARD))


def test_corners_of_a_rendered_board_are_found_to_a_fraction_of_a_pixel() -> None:
    rotation, translation = next(list_poses())
    found = find_corners(Studio(BOARD).take(rotation, translation)[:, :, 0].copy(), BOARD)
    assert found is not None
    truth = project_views(BOARD, noise=0.0)[0].corners
    assert min(np.abs(found - truth).max(), np.abs(found[::-1] - truth).max()) < 0.3


def test_views_of_those_poses_cover_the_picture() -> None:
    coverage = measure_coverage(VIEWS, BOARD)
    assert coverage.is_complete


def test_overlay_marks_what_is_missing_and_the_corners() -> None:
    grey = np.full((480, 640, 3), 128, np.uint8)
    drawn = draw_overlay(grey, CalibrationSession(BOARD, VIEWS, VIEWS[0]))
    assert drawn[475, 635, 1] > drawn[475, 635, 0]  # green
    x, y = VIEWS[0].corners[0].round().astype(int)
    assert drawn[y, x].tolist() == [240, 220, 60]
    begun = draw_overlay(grey, CalibrationSession(BOARD))
    assert begun[5, 5, 0] > begun[5, 5, 1]  # red
    assert "18 of 15 views" in describe(CalibrationSession(BOARD, VIEWS))


def test_view_of_a_board_that_moved_is_left_out() -> None:
    wrong = BoardView(VIEWS[0].corners.copy(), 640, 480)
    wrong.corners[::3] += 12.0
    result = solve([*VIEWS, wrong], BOARD)
    assert_good(result)
    assert result is not None
    assert (result.used, result.given) == (len(VIEWS), len(VIEWS) + 1)


def test_large_error_and_uncertainty_are_refused_with_what_to_do() -> None:
    good = solve(VIEWS, BOARD)
    assert good is not None
    assert "expected at most 1:" in CalibrationResult(good.calibration, 1.4, 0.001, 15, 15, 4).problem
    assert "tilt the board more" in CalibrationResult(good.calibration, 0.2, 0.05, 15, 15, 4).problem


def test_views_from_the_front_alone_are_refused() -> None:
    flat = BOARD.points[:, :2] / 0.5 * 540.0
    views = [BoardView(flat + np.array([x, 150.0]), 640, 480) for x in (50.0, 150.0, 250.0)]
    result = solve(views, BOARD)
    assert result is None or "not tilted enough" in result.problem


def test_too_few_views_have_no_solution() -> None:
    assert solve(VIEWS[:2], BOARD) is None
    with pytest.raises(UserError, match="nothing was changed: 2 views have no solution"):
        solve_or_fail(VIEWS[:2], BOARD)


def test_picture_of_another_size_begins_anew() -> None:
    session = CalibrationSession(BOARD, list(VIEWS))
    session.look(np.zeros((240, 320, 3), np.uint8))
    assert session.views == []
    assert session.event == "no board of 8 x 6 inner corners is seen"
