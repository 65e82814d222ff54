import math

import numpy as np
import pytest
from bench.navigation_parts.geodesic import free_cells, length_of, shortest_path
from bench.navigation_parts.stack import MAPS
from bench.navigation_parts.worlds import GOALS

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2


def room() -> np.ndarray:
    values = np.zeros((120, 160), np.int8)
    values[[0, -1]] = 100
    values[:, [0, -1]] = 100
    return values


@pytest.mark.parametrize("goal", [(7.0, 5.0), (7.0, 1.3), (1.7, 5.2), (6.13, 3.37)])
def test_shortest_path_is_exact_in_the_open(goal: tuple[float, float]) -> None:
    grid = Grid(room(), 0.05, Pose2(0.0, 0.0, 0.0))
    path = shortest_path(grid, free_cells(grid, 0.19), (1.0, 1.0), goal)
    assert path is not None
    assert length_of(path) == pytest.approx(math.dist((1.0, 1.0), goal), rel=1e-3)


def test_shortest_path_round_a_wall_is_a_taut_string() -> None:
    values = room()
    values[:80, 79:81] = 100
    grid = Grid(values, 0.05, Pose2(0.0, 0.0, 0.0))
    path = shortest_path(grid, free_cells(grid, 0.2), (2.0, 1.0), (6.0, 1.0))
    assert path is not None
    # Straight to the circle round the wall's end, along it to its top, across, and the same down again.
    away = math.dist((2.0, 1.0), (3.975, 3.975))
    turn = math.pi - math.atan2(1.975, 2.975) - math.acos(0.2 / away)
    exact = 2 * math.sqrt(away**2 - 0.2**2) + 2 * 0.2 * turn + 0.05
    assert 0.995 * exact <= length_of(path) <= 1.006 * exact


def test_shortest_path_tells_when_there_is_none() -> None:
    values = room()
    values[:, 79:81] = 100
    grid = Grid(values, 0.05, Pose2(0.0, 0.0, 0.0))
    assert shortest_path(grid, free_cells(grid, 0.2), (2.0, 1.0), (6.0, 1.0)) is None


@pytest.mark.parametrize("world", GOALS)
def test_goals_of_a_world_leave_room_for_the_robot(world: str) -> None:
    grid = load_map(str(MAPS / f"{world}.yaml"))
    free = free_cells(grid, 0.3)
    assert len(GOALS[world]) == 10
    for x, y, _ in GOALS[world]:
        row, column = grid.cells_of_points(np.array((x, y)))
        assert free[row, column], (x, y)
