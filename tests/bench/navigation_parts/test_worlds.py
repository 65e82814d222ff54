"""Goals are moved only where a base needs it, and to where it can get and turn."""

import math
from pathlib import Path

import numpy as np
import pytest
from bench.navigation_parts.geodesic import free_cells, shortest_path
from bench.navigation_parts.stack import MAPS
from bench.navigation_parts.worlds import (
    GOALS,
    draw_goals,
    find_world,
    fit_goals,
    is_world,
    passage_radius,
    refuse_size,
)
from scipy.ndimage import label

from ur_nodes.costmap.footprint import Footprint, footprint_of_outline
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2


def box(length: float, width: float, ahead: float = 0.5) -> Footprint:
    """A rectangle, `ahead` of whose length is before the origin."""
    front, side = ahead * length, width / 2.0
    return footprint_of_outline(((front, side), (front - length, side), (front - length, -side), (front, -side)), 0.05)


@pytest.mark.parametrize("world", GOALS)
def test_small_base_drives_to_the_goals_as_they_are(world: str) -> None:
    grid = load_map(str(MAPS / f"{world}.yaml"))
    assert fit_goals(GOALS[world], grid, box(0.3, 0.3)) == GOALS[world]


@pytest.mark.parametrize("world", GOALS)
def test_large_base_gets_to_goals_at_which_it_can_turn(world: str) -> None:
    grid = load_map(str(MAPS / f"{world}.yaml"))
    large = box(0.9, 0.65)
    fitted = fit_goals(GOALS[world], grid, large)
    assert any(goal != moved for goal, moved in zip(GOALS[world], fitted, strict=True))
    assert [goal[2] for goal in fitted] == [goal[2] for goal in GOALS[world]], "headings stay"
    room = free_cells(grid, large.circumscribed)
    pieces, _ = label(free_cells(grid, passage_radius(large)))
    start = pieces[tuple(grid.cells_of_points(np.zeros(2)))]
    assert start > 0
    for x, y, _ in fitted:
        assert room[tuple(grid.cells_of_points(np.array((x, y))))]
        assert pieces[tuple(grid.cells_of_points(np.array((x, y))))] == start


def test_goal_in_a_room_with_too_narrow_a_door_is_moved_out_of_it() -> None:
    values = np.zeros((80, 160), np.int8)
    values[[0, -1]] = values[:, [0, -1]] = 100
    values[:, 80] = 100
    values[36:44, 80] = 0  # 0.4 m wide
    grid = Grid(values, 0.05, Pose2(-1.0, -2.0, 0.0))
    (kept,) = fit_goals(((5.0, 0.0, 0.0),), grid, box(0.2, 0.2))
    (moved,) = fit_goals(((5.0, 0.0, 0.0),), grid, box(0.6, 0.5))
    assert kept == (5.0, 0.0, 0.0)
    assert moved[0] < 3.0


def test_base_that_fits_nowhere_keeps_its_goals() -> None:
    grid = load_map(str(MAPS / "maze.yaml"))
    assert fit_goals(GOALS["maze"], grid, box(3.0, 3.0)) == GOALS["maze"]


def test_passage_of_a_base_is_as_wide_as_its_body_wherever_its_wheels_are() -> None:
    assert passage_radius(box(0.4, 0.38)) == pytest.approx(0.19)
    near_the_front = box(0.5, 0.4, ahead=0.1)
    assert near_the_front.inscribed == pytest.approx(0.05)
    assert passage_radius(near_the_front) == pytest.approx(0.2)
    assert passage_radius(box(0.2, 0.6)) == pytest.approx(0.3)
    assert math.isclose(passage_radius(box(0.3, 0.3)), box(0.3, 0.3).inscribed)


def test_goals_of_a_flat_can_be_reached_and_are_the_same_each_time(tmp_path: Path) -> None:
    world = find_world("flat_1", tmp_path)
    assert Path(world.source).is_file()
    assert len(world.goals) == 10
    assert world.goals == draw_goals(world.grid, 1)
    free = free_cells(world.grid, 0.3)
    assert all(shortest_path(world.grid, free, (0.0, 0.0), (x, y)) is not None for x, y, _ in world.goals)


def test_a_base_that_cannot_leave_the_start_is_refused(tmp_path: Path) -> None:
    world = find_world("flat_1", tmp_path)
    assert refuse_size(world, "stage", box(0.4, 0.38)) == ""
    assert "large is too large for flat_1: it needs passages of 3.00 m" in refuse_size(world, "large", box(3.0, 3.0))


def test_worlds_are_known_by_name() -> None:
    assert [is_world(name) for name in ("maze", "flat_12", "flat_", "flat", "../flat_1")] == [
        True,
        True,
        False,
        False,
        False,
    ]
