"""The shortest way on the inflated grid: what every planner is held against.

The robot is a disc as wide as the passages that it needs, obstacles are the map's occupied cells, unknown is
forbidden. Dijkstra over the free cells with moves in 32 directions (all coprime steps of at most 3 cells) is at most
1.4 % too long, by the angle between two directions; pulling the result taut (the best chain of straight free lines
between its points, repeated until nothing gains) takes that out again. What is left is within a few millimetres per
corner of the exact geodesic, and lines may graze the corners of forbidden cells, so it errs towards too short: not in
our favour.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ur_nodes.geometry.grid import Grid

# Coprime steps: one per direction; half of them, the other half goes back.
_STEPS = [(r, c) for r in range(4) for c in range(-3, 4) if math.gcd(r, c) == 1 and (r > 0 or c > 0)]


def free_cells(grid: Grid, radius: float) -> NDArray[np.bool_]:
    """Where a disc of `radius` m fits (height, width): known, and obstacles are farther away, centre to centre."""
    occupied = grid.values >= 65
    clear: NDArray[np.bool_] = (distance_transform_edt(~occupied) * grid.resolution > radius) & (grid.values >= 0)
    return clear


def shortest_path(
    grid: Grid, free: NDArray[np.bool_], start: tuple[float, float], goal: tuple[float, float]
) -> NDArray[np.float64] | None:
    """The corners (n, 2) in m of the shortest way over free cells; None when there is none."""
    numbers = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    begin, end = (int(numbers[tuple(grid.cells_of_points(np.array(place)))]) for place in (start, goal))
    if begin < 0 or end < 0:
        return None
    graph = _graph(numbers, int(free.sum()))
    totals, before = dijkstra(graph, directed=False, indices=begin, return_predecessors=True)
    if not np.isfinite(totals[end]):
        return None
    chain = [end]
    while chain[-1] != begin:
        chain.append(int(before[chain[-1]]))
    points = grid.points_of_cells(np.argwhere(free)[chain[::-1]])
    points[0], points[-1] = start, goal
    return _pull_taut(grid, free, points)


def _graph(numbers: NDArray[np.intp], count: int) -> csr_array:
    """Free cells joined in half of the directions (the graph is used both ways), weights in cells."""
    height, width = numbers.shape
    rows, columns, weights = [], [], []
    for r, c in _STEPS:
        here = numbers[max(0, -r) : height - max(0, r), max(0, -c) : width - max(0, c)]
        there = numbers[max(0, r) : height + min(0, r), max(0, c) : width + min(0, c)]
        both = (here >= 0) & (there >= 0)
        rows.append(here[both])
        columns.append(there[both])
        weights.append(np.full(int(both.sum()), math.hypot(r, c)))
    places = (np.concatenate(rows), np.concatenate(columns))
    return csr_array((np.concatenate(weights), places), shape=(count, count))


def length_of(points: NDArray[np.float64]) -> float:
    """The length of a polyline (n, 2)."""
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _pull_taut(grid: Grid, free: NDArray[np.bool_], points: NDArray[np.float64]) -> NDArray[np.float64]:
    before = math.inf
    while length_of(points) < before - 1e-3:
        before = length_of(points)
        points = _best_chain(grid, free, _subdivided(points, grid.resolution))
    return points


def _best_chain(
    grid: Grid, free: NDArray[np.bool_], points: NDArray[np.float64], reach: int = 160
) -> NDArray[np.float64]:
    """The shortest chain of free straight lines from the first to the last of the points, through some of them."""
    count = len(points)
    best = np.full(count, math.inf)
    best[0] = 0.0
    came = np.zeros(count, np.intp)
    for here in range(count - 1):
        ends = np.arange(here + 1, min(count, here + reach))
        lengths = np.hypot(*(points[ends] - points[here]).T)
        gains = best[here] + lengths < best[ends] - 1e-9
        ends, lengths = ends[gains], lengths[gains]
        if not len(ends):
            continue
        open_ = _lines_are_free(grid, free, points[here], points[ends])
        open_[0] |= ends[0] == here + 1  # neighbours are joined already
        ends, lengths = ends[open_], lengths[open_]
        best[ends], came[ends] = best[here] + lengths, here
    chain = [count - 1]
    while chain[-1] != 0:
        chain.append(int(came[chain[-1]]))
    return points[chain[::-1]]


def _lines_are_free(
    grid: Grid, free: NDArray[np.bool_], start: NDArray[np.float64], ends: NDArray[np.float64]
) -> NDArray[np.bool_]:
    steps = math.ceil(float(np.hypot(*(ends - start).T).max()) / (0.4 * grid.resolution)) + 1
    points = start + np.linspace(0.0, 1.0, steps)[:, None, None] * (ends - start)
    cells = grid.cells_of_points(points)
    on_free: NDArray[np.bool_] = np.all(free[cells[..., 0], cells[..., 1]], axis=0)
    return on_free


def _subdivided(points: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    pieces = [points[:1]]
    for a, b in pairwise(points):
        count = max(1, math.ceil(float(np.hypot(*(b - a))) / spacing))
        pieces.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(pieces)
