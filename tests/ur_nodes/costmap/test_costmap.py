import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.costmap.costmap import (
    INSCRIBED,
    LETHAL,
    UNKNOWN,
    Costmap,
    Inflation,
    costs_of_grid,
    inflate,
    inflate_window,
    occupancy_of_costs,
)
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

INFLATION = Inflation(inscribed=0.2, radius=0.55, scaling=10.0)


def test_inflate_follows_the_formula_of_costmap_2d() -> None:
    costs = np.zeros((41, 41), np.uint8)
    costs[20, 20] = LETHAL
    inflated = inflate(costs, 0.05, INFLATION)
    for row in range(41):
        for column in range(41):
            distance = math.hypot(row - 20, column - 20) * 0.05
            if distance == 0.0:
                expected = 254
            elif distance <= 0.2:
                expected = 253
            elif distance <= 0.55:
                expected = int(252 * math.exp(-10.0 * (distance - 0.2)))
            else:
                expected = 0
            assert abs(int(inflated[row, column]) - expected) <= (1 if abs(distance - 0.2) > 1e-9 else 2)


def test_inflate_keeps_unknown_unless_an_obstacle_is_within_the_robots_circle() -> None:
    costs = np.full((21, 21), UNKNOWN, np.uint8)
    costs[10, 10] = LETHAL
    inflated = inflate(costs, 0.05, INFLATION)
    assert inflated[10, 10] == LETHAL
    assert inflated[10, 13] == INSCRIBED
    assert inflated[10, 18] == UNKNOWN


def test_inflate_without_obstacles_changes_nothing() -> None:
    costs = np.zeros((5, 5), np.uint8)
    assert (inflate(costs, 0.05, INFLATION) == 0).all()


@given(
    st.lists(st.tuples(st.integers(0, 49), st.integers(0, 59)), min_size=1, max_size=12),
    st.lists(st.tuples(st.integers(20, 29), st.integers(30, 39)), min_size=1, max_size=6),
)
def test_inflate_window_gives_what_inflating_everything_gives(
    walls: list[tuple[int, int]], changed: list[tuple[int, int]]
) -> None:
    costs = np.zeros((50, 60), np.uint8)
    for wall in walls:
        costs[wall] = LETHAL
    master = inflate(costs, 0.05, INFLATION)
    for cell in changed:
        costs[cell] = 0 if costs[cell] == LETHAL else LETHAL
    inflate_window(master, lambda box: costs[box], 0.05, INFLATION, (slice(20, 30), slice(30, 40)))
    assert (master == inflate(costs, 0.05, INFLATION)).all()


def test_costs_of_grid_tells_obstacle_free_and_unknown_apart() -> None:
    grid = Grid(np.array([[-1, 0, 64, 65, 100]], np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    assert costs_of_grid(grid, lethal=65).tolist() == [[UNKNOWN, 0, 0, LETHAL, LETHAL]]
    assert costs_of_grid(grid, lethal=65, track_unknown=False)[0, 0] == 0


def test_occupancy_of_costs_uses_the_scale_that_viewers_know() -> None:
    shown = occupancy_of_costs(np.array([0, 1, 252, 253, 254, 255], np.uint8)).tolist()
    assert shown == [0, 1, 98, 99, 100, -1]


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_costmap_finds_a_cell_again_from_its_centre(yaw: float) -> None:
    costmap = Costmap(np.arange(12, dtype=np.uint8).reshape(3, 4), 0.1, Pose2(1.0, -2.0, yaw))
    cells = np.moveaxis(np.indices((3, 4)), 0, -1)
    assert (costmap.costs_at(costmap.points_of_cells(cells)) == costmap.costs).all()
    assert costmap.costs_at(np.array((50.0, 50.0))) == UNKNOWN
