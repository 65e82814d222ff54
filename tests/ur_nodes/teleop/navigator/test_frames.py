from __future__ import annotations

import math

import numpy as np
import pytest

from ur_nodes.teleop.navigator.frames import FrameTree, Link, move_points, scan_points

QUARTER = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))


def tree() -> FrameTree:
    frames = FrameTree()
    frames.update("odom", Link("map", 1.0, 2.0, 0.0, *QUARTER))
    frames.update("/base_footprint", Link("odom", 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
    frames.update("laser", Link("base_footprint", 0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0))  # upside down
    return frames


def test_place_goes_through_the_chain() -> None:
    assert tree().place("map", "base_footprint") == pytest.approx((1.0, 3.0, math.pi / 2))


def test_frames_that_are_not_connected_have_no_place() -> None:
    assert tree().place("map", "camera") is None
    assert FrameTree().place("map", "base_footprint") is None


def test_loop_of_frames_ends() -> None:
    frames = FrameTree()
    frames.update("a", Link("b", 0, 0, 0, 0, 0, 0, 1))
    frames.update("b", Link("a", 0, 0, 0, 0, 0, 0, 1))
    assert frames.place("map", "a") is None


def test_scan_of_an_upside_down_lidar_is_mirrored() -> None:
    matrix = tree().matrix("base_footprint", "laser")
    assert matrix is not None
    points = scan_points(np.array([2.0]), math.pi / 2, 0.1, 0.1, 10.0)
    assert move_points(matrix, points)[0] == pytest.approx((0.0, -2.0, 0.3), abs=1e-12)


def test_beams_without_a_hit_are_left_out() -> None:
    ranges = np.array([1.0, np.inf, np.nan, -np.inf, 10.0, 0.05])
    assert scan_points(ranges, 0.0, 0.1, 0.1, 10.0).shape == (1, 3)


def test_all_zero_rotation_counts_as_none() -> None:
    frames = FrameTree()
    frames.update("odom", Link("map", 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert frames.place("map", "odom") == (1.0, 0.0, 0.0)
