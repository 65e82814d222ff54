import numpy as np
import pytest

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.kept_map import KeptMap
from ur_nodes.ports.values import Map, MapUpdate


def make_map() -> Map:
    return Map(0, "map", Grid(np.zeros((4, 5), np.int8), 0.05, Pose2(0.0, 0.0, 0.0)))


def test_update_changes_its_cells_of_its_own_copy_and_no_others() -> None:
    kept, given = KeptMap(), make_map()
    assert kept.apply(MapUpdate(0, "map", 3, 2, np.array([[7, 8]], np.int8))) == ""
    kept.replace(given)
    assert kept.apply(MapUpdate(0, "map", 3, 2, np.array([[7, 8]], np.int8))) == ""
    assert kept.map is not None
    assert kept.map.grid.values[3].tolist() == [0, 0, 7, 8, 0]
    assert not kept.map.grid.values[:3].any()
    assert not given.grid.values.any()


@pytest.mark.parametrize(("row", "column"), [(4, 0), (0, 4), (-1, 0), (0, -1)])
def test_update_that_does_not_fit_is_refused(row: int, column: int) -> None:
    kept = KeptMap()
    kept.replace(make_map())
    assert "inside the grid of 5 x 4" in kept.apply(MapUpdate(0, "map", row, column, np.ones((1, 2), np.int8)))
    assert kept.map is not None
    assert not kept.map.grid.values.any()
