import numpy as np
import pytest
from tests.ur_nodes.exploration.drawn import draw, place

from ur_nodes.exploration.search.floor import Floor, read_floor
from ur_nodes.exploration.search.frontiers import continue_walls

LINE = "????????????\n????????????\n###?????????\n............"


def floor_of(values: np.ndarray | str) -> Floor:
    grid = draw(values) if isinstance(values, str) else draw(LINE)
    if not isinstance(values, str):
        grid = type(grid)(values, grid.resolution, grid.origin)
    return read_floor(grid, place(1, 3, LINE), 0.2)


def thin_wall(angle: float) -> np.ndarray:
    """A wall of one cell, 1.5 m long at an angle (rad), in unknown space of 5 m."""
    values = np.full((100, 100), -1, np.int8)
    along = np.arange(0.0, 1.5, 0.02)
    rows, columns = (np.rint((0.5 + along * part) / 0.05).astype(int) for part in (np.sin(angle), np.cos(angle)))
    values[rows, columns] = 100
    return values


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 4, np.pi / 2])
def test_wall_goes_on_straight_where_it_ends_in_unknown_space(angle: float) -> None:
    found = continue_walls(floor_of(thin_wall(angle)), 1.0)
    ahead = np.array([0.5 + 2.0 * np.sin(angle), 0.5 + 2.0 * np.cos(angle)]) / 0.05
    near = np.hypot(*(np.argwhere(found) - ahead).T)
    assert near.min() < 4.0
    end = 0.5 + 2.7 * np.array([np.sin(angle), np.cos(angle)])
    assert np.hypot(*(np.argwhere(found) * 0.05 - end).T).min() > 0.1


def test_wall_does_not_go_on_beyond_known_floor() -> None:
    values = thin_wall(0.0)
    values[:, 45:50] = 0
    found = continue_walls(floor_of(values), 2.0)
    assert found[10, 41:45].all()
    assert not found[:, 45:].any()


def test_map_without_walls_has_none_that_go_on() -> None:
    assert not continue_walls(floor_of(np.full((20, 20), -1, np.int8))).any()


def test_only_unknown_cells_are_taken_for_walls() -> None:
    floor = floor_of(thin_wall(0.4))
    assert floor.unknown[continue_walls(floor)].all()
