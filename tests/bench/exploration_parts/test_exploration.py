import math
from pathlib import Path

import numpy as np
import pytest
from bench.exploration_parts.flat import make_flat, write_flat
from bench.exploration_parts.quick import explore_quickly
from bench.exploration_parts.truth import Truth, greedy_way

from ur.worlds.world_file import read_world
from ur_nodes.exploration.explorer_step import ExplorerSettings
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


def two_rooms() -> Truth:
    """Two rooms of 2 m, joined by a door of 0.9 m; the robot begins in the left one."""
    values = np.zeros((44, 84), np.int8)
    values[[0, 1, -2, -1]] = values[:, [0, 1, -2, -1]] = 100
    values[:, 41:43] = 100
    values[4:22, 41:43] = 0
    return Truth(Grid(values, 0.05, Pose2(-1.0, -1.6, 0.0)), 0.2)


def test_explorer_finds_the_second_room_and_drives_hardly_farther_than_one_that_knows_the_map() -> None:
    truth = two_rooms()
    result = explore_quickly(truth, ExplorerSettings(radius=0.2))
    assert result.status.state == "complete"
    assert result.share > 0.95
    assert result.touched == 0
    assert 0.0 < greedy_way(truth, 0.98) < 4.0
    assert result.way < 4.0
    assert math.isnan(result.off)  # it is over before anything is estimated


def test_reachable_floor_ends_where_the_robot_does_not_fit() -> None:
    truth = two_rooms()
    assert truth.floor.sum() * 0.0025 == pytest.approx(8.0, rel=0.06)
    narrow = Truth(truth.grid, 0.5)
    assert narrow.floor.sum() < 0.6 * truth.floor.sum()


def test_lidar_of_the_bench_measures_the_walls() -> None:
    truth = two_rooms()
    ranges = truth.ranges(0.0, 0.0)
    assert ranges[180] == pytest.approx(0.9, abs=0.05)
    assert ranges[90] == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("seed", range(5))
def test_flats_can_be_entered_and_are_worlds_of_the_simulator(seed: int, tmp_path: Path) -> None:
    plan = make_flat(seed).floor_plan
    grid = Grid(np.where(plan.walls, 100, 0).astype(np.int8), plan.resolution, Pose2(*plan.origin))
    truth = Truth(grid, 0.2)
    inside = float((~truth.walls).sum())
    assert truth.floor.sum() > 0.9 * inside
    assert np.array_equal(read_world(write_flat(seed, tmp_path)).floor_plan.walls, plan.walls)
    assert np.array_equal(make_flat(seed).floor_plan.values, plan.values)
