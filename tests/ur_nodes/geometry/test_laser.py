from __future__ import annotations

import math

import numpy as np
import pytest

from ur_nodes.geometry.laser import directions_of_beams, mount_of_pose, points_of_ranges
from ur_nodes.geometry.pose import make_pose3

BEAMS = directions_of_beams(4, 0.0, math.pi / 2.0)
LIMITS = (0.1, 10.0)


def test_points_of_ranges_allows_for_the_mount() -> None:
    half = math.sqrt(0.5)
    mount = mount_of_pose(make_pose3((0.2, 0.0, 0.3), (0.0, 0.0, half, half)))  # turned to the left
    points = points_of_ranges(np.array((1.0, 2.0, 3.0, 4.0)), BEAMS, LIMITS, mount)
    assert points == pytest.approx(np.array(((0.2, 1.0), (-1.8, 0.0), (0.2, -3.0), (4.2, 0.0))))


def test_points_of_ranges_mirrors_a_lidar_that_hangs_upside_down() -> None:
    mount = mount_of_pose(make_pose3((0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)))  # rolled by half a turn
    points = points_of_ranges(np.array((1.0, 2.0, 3.0, 4.0)), BEAMS, LIMITS, mount)
    assert points == pytest.approx(np.array(((1.0, 0.0), (0.0, -2.0), (-3.0, 0.0), (0.0, 4.0))))


def test_points_of_ranges_leaves_out_what_hit_nothing() -> None:
    mount = mount_of_pose(make_pose3((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    ranges = np.array((math.inf, math.nan, 10.0, 0.05), dtype=np.float32)
    assert points_of_ranges(ranges, BEAMS, LIMITS, mount).shape == (0, 2)
