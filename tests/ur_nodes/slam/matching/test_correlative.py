from __future__ import annotations

import math

import pytest
from tests.ur_nodes.slam.rooms import CORRIDOR, ROOM, Floats, scan_at

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.correlative import Found, Pyramid, Window, search

HERE = Pose2(0.0, 0.0, 0.0)


def look(true: Pose2, window: Window, walls: Floats = ROOM) -> Found | None:
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
