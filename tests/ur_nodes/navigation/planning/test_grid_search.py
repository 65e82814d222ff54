import numpy as np
import pytest

from ur_nodes.navigation.planning import grid_search
from ur_nodes.navigation.planning.grid_search import find_cell_path

WEIGHTS = np.where(np.arange(256) < 253, 1.0 + 0.006 * np.arange(256), np.inf)


def rooms(seed: int, side: int = 240) -> np.ndarray:
    """Walls every 40 cells, each with a gap in some places, and slopes of costs."""
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 60, (side, side)).astype(np.uint8)
    for wall in range(39, side - 1, 40):
        costs[wall : wall + 3] = costs[:, wall : wall + 3] = 254
    for wall in range(39, side - 1, 40):
        for start in range(0, side - 39, 40):
            place = start + int(rng.integers(5, 30))
            if rng.random() < 0.6:
                costs[wall : wall + 3, place : place + 2] = 10
            if rng.random() < 0.6:
                costs[place : place + 2, wall : wall + 3] = 10
    return costs


def cost_of(costs: np.ndarray, path: np.ndarray) -> float:
    weights = WEIGHTS[costs[tuple(path.T)]]
    return float((np.hypot(*np.diff(path, axis=0).T) * 0.5 * (weights[1:] + weights[:-1])).sum())


@pytest.mark.parametrize("seed", range(6))
def test_find_cell_path_in_a_large_map_finds_what_a_search_of_the_whole_finds(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    costs, rng = rooms(seed), np.random.default_rng(seed)
    free = np.argwhere(costs < 253)
    for _ in range(5):
        start, goal = (tuple(free[index].tolist()) for index in rng.integers(len(free), size=2))
        exact = find_cell_path(costs, WEIGHTS, start, goal)
        with monkeypatch.context() as patch:
            patch.setattr(grid_search, "EXACT", 0)
            path = find_cell_path(costs, WEIGHTS, start, goal)
        assert (path is None) == (exact is None)
        if path is None or exact is None:
            continue
        assert path[0].tolist() == list(start)
        assert path[-1].tolist() == list(goal)
        assert np.abs(np.diff(path, axis=0)).max(initial=0) <= 1
        assert np.isfinite(WEIGHTS[costs[tuple(path.T)]]).all()
        assert cost_of(costs, path) <= 1.03 * cost_of(costs, exact) + 1e-9


def test_path_that_begins_in_the_wrong_direction() -> None:
    """The only door of a long wall is at its far end, far outside of the window that is searched first."""
    costs = np.zeros((1200, 900), np.uint8)
    costs[:1190, 450:453] = 254
    path = find_cell_path(costs, WEIGHTS, (5, 440), (5, 470))
    assert path is not None
    assert path[:, 0].max() >= 1190


def test_find_cell_path_in_a_large_map_reports_a_closed_room() -> None:
    costs = np.zeros((900, 900), np.uint8)
    costs[400:500, 400] = costs[400:500, 499] = costs[400, 400:500] = costs[499, 400:500] = 254
    assert find_cell_path(costs, WEIGHTS, (450, 450), (100, 100)) is None
    assert find_cell_path(costs, WEIGHTS, (100, 100), (450, 450)) is None
