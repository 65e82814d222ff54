import itertools
import math

import numpy as np
import pytest
from tests.ur_nodes.slam.rooms import CORRIDOR, ROOM, Floats, scan_at

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.correlative import CorrelativeMatch, Pyramid, Window, search, search_slowly

HERE = Pose2(0.0, 0.0, 0.0)


def look(true: Pose2, window: Window, walls: Floats = ROOM) -> CorrelativeMatch | None:
    pyramid = Pyramid(scan_at(walls, HERE).surface.points)
    return search(pyramid, scan_at(walls, true, 0.01).surface.points[::3], HERE, window)


@pytest.mark.parametrize("true", [Pose2(1.2, 0.4, 0.4), Pose2(-0.9, 1.5, -0.45), Pose2(0.0, 0.0, 0.0)])
def test_pose_far_from_the_guess_is_found_to_a_cell(true: Pose2) -> None:
    found = look(true, Window(2.0, 0.5))
    assert found is not None
    assert math.hypot(found.pose.x - true.x, found.pose.y - true.y) < 0.1
    assert found.pose.yaw == pytest.approx(true.yaw, abs=0.03)
    assert found.score > found.rival


def test_two_places_fit_in_a_corridor() -> None:
    found = look(HERE, Window(2.0, 0.1), CORRIDOR)
    assert found is not None
    assert found.rival > 0.85 * found.score


def test_nothing_is_found_where_the_scan_fits_nowhere() -> None:
    pyramid = Pyramid(scan_at(CORRIDOR, HERE).surface.points)
    assert search(pyramid, scan_at(ROOM, HERE).surface.points[::3], HERE, Window(0.5, 0.2), 0.9) is None


def test_no_pose_of_the_window_is_better_than_the_one_found() -> None:
    pyramid = Pyramid(scan_at(ROOM, HERE).surface.points)
    points = scan_at(ROOM, Pose2(0.31, -0.22, 0.17), 0.01).surface.points[::3]
    found = search(pyramid, points, HERE, Window(0.6, 0.3))
    assert found is not None
    shifts, turns = np.arange(-0.6, 0.601, 0.05), np.arange(-0.3, 0.301, 0.02)
    others = [score_of(pyramid, points, Pose2(x, y, yaw)) for x, y, yaw in itertools.product(shifts, shifts, turns)]
    assert found.score == pytest.approx(score_of(pyramid, points, found.pose), abs=0.02)
    assert found.score >= max(others) - 0.03


def score_of(pyramid: Pyramid, points: Floats, pose: Pose2) -> float:
    columns, rows = np.floor((pose.transform_points(points) - pyramid.low) / pyramid.cell).astype(int).T
    level = np.pad(pyramid.levels[0], 100)
    return float(level[rows + 100, columns + 100].mean() / level.max())


def test_wide_search_is_done_in_parts_of_bounded_size() -> None:
    pyramid = Pyramid(scan_at(ROOM, HERE).surface.points)
    points = scan_at(ROOM, Pose2(1.2, 0.4, 0.4), 0.01).surface.points
    parts = list(search_slowly(pyramid, points, HERE, Window(8.0, 0.5)))
    assert sum(parts) > 5000
    assert max(parts) < 5000
