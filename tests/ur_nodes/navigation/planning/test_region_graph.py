import numpy as np
import pytest
from scipy.ndimage import label
from scipy.sparse.csgraph import connected_components

from ur_nodes.navigation.planning.region_graph import cell_graph, find_regions

WEIGHTS = np.where(np.arange(256) < 253, 1.0 + 0.006 * np.arange(256), np.inf)


def random_costs(seed: int, share: float = 0.4) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.where(rng.random((45, 61)) < share, 254, rng.integers(0, 200, (45, 61))).astype(np.uint8)


@pytest.mark.parametrize("size", [4, 16])
@pytest.mark.parametrize("seed", range(5))
def test_regions_are_connected_just_as_their_cells_are(seed: int, size: int) -> None:
    costs = random_costs(seed, 0.55)
    regions = find_regions(costs, WEIGHTS, size)
    _, member = connected_components(regions.graph.steps, directed=False)
    labels, _ = label(costs < 253, np.ones((3, 3)))
    cells = [tuple(cell) for cell in np.argwhere(labels)[::17].tolist()]
    for one in cells[:20]:
        for other in cells:
            together = member[regions.region_of(one)] == member[regions.region_of(other)]
            assert together == (labels[one] == labels[other])


def test_regions_know_their_centres_and_mean_weights() -> None:
    costs = np.full((8, 8), 254, np.uint8)
    costs[0:4, 0:2] = 100
    costs[1, 3] = 0
    regions = find_regions(costs, WEIGHTS, 4)
    assert regions.graph.points.tolist() == [[1.5, 0.5], [1.0, 3.0]]
    assert regions.blocks.tolist() == [[0, 0], [0, 0]]


def test_cell_graph_joins_eight_neighbours_with_the_cost_of_the_step() -> None:
    costs = np.array([[0, 100, 254], [254, 0, 0]], np.uint8)
    graph = cell_graph(costs, WEIGHTS, np.array([0, 1, 4, 5]))
    steps = graph.steps.toarray()
    assert steps[0].tolist() == pytest.approx([0.0, 1.3, 2**0.5, 0.0])
    assert steps[1].tolist() == pytest.approx([1.3, 0.0, 1.3, 2**0.5 * 1.3])
    assert steps[2, 3] == pytest.approx(1.0)
