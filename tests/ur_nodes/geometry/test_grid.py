import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

coordinates = st.floats(-100.0, 100.0)
grids = st.builds(
    lambda resolution, x, y, yaw: Grid(np.zeros((30, 40), dtype=np.int8), resolution, Pose2(x, y, yaw)),
    st.floats(0.01, 2.0),
    coordinates,
    coordinates,
    st.floats(-math.pi, math.pi),
)


@given(grids, st.integers(-50, 80), st.integers(-50, 80))
def test_cells_of_points_inverts_points_of_cells(grid: Grid, row: int, column: int) -> None:
    cell = np.array((row, column))
    assert grid.cells_of_points(grid.points_of_cells(cell)).tolist() == [row, column]


@given(grids, coordinates, coordinates)
def test_point_is_within_half_a_diagonal_of_its_cells_centre(grid: Grid, x: float, y: float) -> None:
    point = np.array((x, y))
    centre = grid.points_of_cells(grid.cells_of_points(point))
    assert math.dist(point, centre) <= grid.resolution * math.sqrt(0.5) + 1e-9


def test_cells_of_points_turns_with_the_origin() -> None:
    grid = Grid(np.zeros((3, 5), dtype=np.int8), 1.0, Pose2(10.0, 20.0, math.pi / 2.0))
    # Columns run along +y, rows along -x of the map.
    assert grid.cells_of_points(np.array((8.5, 24.5))).tolist() == [1, 4]


def test_values_at_gives_the_outside_value_beyond_the_edges() -> None:
    grid = Grid(np.array([[0, 100], [-1, 50]], dtype=np.int8), 0.5, Pose2(0.0, 0.0, 0.0))
    points = np.array(((0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75), (1.25, 0.25), (-0.01, 0.25)))
    assert grid.values_at(points, outside=7).tolist() == [0, 100, -1, 50, 7, 7]


def test_bounds_of_a_turned_map() -> None:
    grid = Grid(np.zeros((10, 20), np.int8), 0.1, Pose2(1.0, 1.0, math.pi / 2))
    assert grid.bounds == pytest.approx((0.0, 1.0, 1.0, 3.0))
