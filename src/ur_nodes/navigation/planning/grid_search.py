"""The cheapest chain of cells between two cells of a costmap of any size.

A small map is searched whole. On a larger one a window round both ends is searched coarse to fine: the regions of
blocks of 16 cells show where paths of about the least cost can be, those of 4 cells among them give one path, and the
search over cells follows it with some room on both sides. The window grows while a path that leaves it could be
cheaper, and until a path is found or the whole map was searched, so that a path is found where there is one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra
from skimage.graph import MCP_Geometric

from ur_nodes.navigation.planning.region_graph import Regions, cell_graph, find_regions

Cell = tuple[int, int]

EXACT = 300_000
"""Cells of a map that is searched whole."""

_COARSE, _FINE = 16, 4  # cells a side of a block
_MARGIN = 100  # cells of a window beyond both ends, at least
_SLACK, _MORE = 1.12, 40.0  # a coarse path may cost so much more than the best: factor, and cells
_WIDEST = 40  # blocks per block of the best coarse path that the next search reads
_BESIDE = 4  # fine blocks on both sides of the path, in which cells are searched


def find_cell_path(
    costs: NDArray[np.uint8], weights: NDArray[np.float64], start: Cell, goal: Cell
) -> NDArray[np.int64] | None:
    """The cells (n, 2) from `start` to `goal`, both free; None when nothing connects them.

    `weights` (256) is the cost of a metre in a cell for each byte, at least 1, inf where the robot must not go. A step
    to one of eight neighbours costs its length times the mean weight of its ends. Deterministic.
    """
    if costs.size <= EXACT:
        return _search_whole(costs, weights, start, goal)
    margin = max(_MARGIN, math.ceil(0.5 * math.dist(start, goal)))
    while True:
        window = _window(costs.shape, start, goal, margin)
        # The costs may change during the search: it uses one copy.
        part = _Part(np.array(costs[window.rows, window.columns]), weights, window)
        path = _search_part(part, _moved(start, window), _moved(goal, window))
        if not isinstance(path, float):
            return None if path is None else path + np.array((window.rows.start, window.columns.start))
        margin = max(2 * margin, math.ceil(0.6 * path)) if math.isfinite(path) else 2 * margin


@dataclass(frozen=True, slots=True)
class _Window:
    """A part of a map. `opens`: at which of its first row, last row, first column, last column the map goes on."""

    rows: slice
    columns: slice
    opens: tuple[bool, bool, bool, bool]


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    costs: NDArray[np.uint8]
    weights: NDArray[np.float64]
    window: _Window


def _window(shape: tuple[int, ...], start: Cell, goal: Cell, margin: int) -> _Window:
    rows, columns = (
        slice(max(0, min(a, b) - margin), min(length, max(a, b) + margin + 1))
        for a, b, length in zip(start, goal, shape, strict=True)
    )
    opens = (rows.start > 0, rows.stop < shape[0], columns.start > 0, columns.stop < shape[1])
    return _Window(rows, columns, opens)


def _moved(cell: Cell, window: _Window) -> Cell:
    return cell[0] - window.rows.start, cell[1] - window.columns.start


def _least_outside(part: _Part, start: Cell, goal: Cell) -> float:
    """The least length, in cells, of a path that leaves a window at a side where the map goes on."""
    height, width = part.costs.shape
    rows, columns = abs(start[0] - goal[0]), abs(start[1] - goal[1])
    lengths = (
        math.hypot(columns, start[0] + goal[0]),
        math.hypot(columns, 2 * height - start[0] - goal[0]),
        math.hypot(rows, start[1] + goal[1]),
        math.hypot(rows, 2 * width - start[1] - goal[1]),
    )
    return min((length for length, opens in zip(lengths, part.window.opens, strict=True) if opens), default=math.inf)


def _search_whole(
    costs: NDArray[np.uint8], weights: NDArray[np.float64], start: Cell, goal: Cell
) -> NDArray[np.int64] | None:
    table = np.where(np.isfinite(weights), weights, -1.0)
    search = MCP_Geometric(table[costs])
    totals, _ = search.find_costs([start], [goal])
    return np.array(search.traceback(goal), np.int64) if np.isfinite(totals[goal]) else None


def _search_part(part: _Part, start: Cell, goal: Cell) -> NDArray[np.int64] | float | None:
    """The path in a window. None: there is none on the whole map. A number: search farther, it costs about so much."""
    costs, weights = part.costs, part.weights
    limit = _least_outside(part, start, goal)
    coarse = find_regions(costs, weights, _COARSE)
    ends = [coarse.region_of(start), coarse.region_of(goal)]
    there, back = dijkstra(coarse.graph.steps, indices=ends)
    best = float(there[ends[1]])
    if not math.isfinite(best):
        leaves = all(_reaches_out(coarse, part.window, totals) for totals in (there, back))
        return math.inf if leaves else None
    if 0.8 * best > limit:
        return best
    near = _refined(_near_the_best(coarse, there + back, best), costs.shape)
    fine = find_regions(costs, weights, _FINE, near)
    begin, end = fine.region_of(start), fine.region_of(goal)
    _, before = dijkstra(fine.graph.steps, indices=begin, return_predecessors=True)
    cells = _cells_beside(fine, _chain(before, begin, end))
    graph = cell_graph(costs, weights, cells)
    begin, end = (int(np.searchsorted(cells, row * costs.shape[1] + column)) for row, column in (start, goal))
    totals, before = dijkstra(graph.steps, indices=begin, return_predecessors=True)
    if totals[end] > limit:
        return float(totals[end])
    return graph.points[_chain(before, begin, end)].astype(np.int64)


def _reaches_out(regions: Regions, window: _Window, totals: NDArray[np.float64]) -> bool:
    """Return True when regions with finite totals lie in blocks at a side of the window where the map goes on."""
    rows, columns = regions.blocks[np.isfinite(totals)].T
    height, width = regions.shape
    sides = (rows == 0, rows == height - 1, columns == 0, columns == width - 1)
    return any(opens and bool(side.any()) for side, opens in zip(sides, window.opens, strict=True))


def _near_the_best(regions: Regions, totals: NDArray[np.float64], best: float) -> NDArray[np.bool_]:
    """Select the blocks that a path of about the least cost may cross; their number grows with its length."""
    most = _WIDEST * (10 + int(best / regions.size))
    chosen = np.flatnonzero(totals <= _SLACK * best + _MORE)
    if len(chosen) > most:
        chosen = chosen[np.argpartition(totals[chosen], most)[:most]]
        chosen = np.union1d(chosen, np.flatnonzero(totals <= best * (1.0 + 1e-9)))
    blocks = np.zeros(regions.shape, bool)
    blocks[tuple(regions.blocks[chosen].T)] = True
    return blocks


def _refined(blocks: NDArray[np.bool_], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return the blocks of `_FINE` cells in those of `_COARSE` cells."""
    times = _COARSE // _FINE
    larger = blocks.repeat(times, axis=0).repeat(times, axis=1)
    return larger[: -(-shape[0] // _FINE), : -(-shape[1] // _FINE)]


def _cells_beside(regions: Regions, chain: list[int]) -> NDArray[np.int64]:
    """The free cells, as numbers in ascending order, of the blocks of a chain of regions and those beside it."""
    reach = np.arange(-_BESIDE, _BESIDE + 1)
    around = np.stack(np.meshgrid(reach, reach), axis=-1).reshape(-1, 2)
    blocks = (regions.blocks[chain][:, None] + around).reshape(-1, 2)
    height, width = regions.shape
    inside = (blocks >= 0).all(axis=1) & (blocks[:, 0] < height) & (blocks[:, 1] < width)
    numbers = np.unique(blocks[inside, 0].astype(np.int64) * width + blocks[inside, 1])
    offsets = np.arange(regions.size)
    rows = (numbers // width * regions.size)[:, None, None] + offsets[:, None]
    columns = (numbers % width * regions.size)[:, None, None] + offsets
    rows, columns = np.broadcast_arrays(rows, columns)
    good = (rows < regions.costs.shape[0]) & (columns < regions.costs.shape[1])
    rows, columns = rows[good], columns[good]
    good = regions.free[regions.costs[rows, columns]]
    return np.sort(rows[good] * regions.costs.shape[1] + columns[good])


def _chain(before: NDArray[np.int32], begin: int, end: int) -> list[int]:
    chain = [end]
    while chain[-1] != begin:
        chain.append(int(before[chain[-1]]))
    return chain[::-1]
