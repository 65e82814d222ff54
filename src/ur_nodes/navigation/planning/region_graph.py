"""Graphs of a costmap for searches from coarse to fine: regions of blocks of cells, or the cells themselves.

A region is a part of a block whose cells are connected within it, so that a chain of neighbouring regions can always be
driven, however thin walls are: unlike cells that are merely enlarged, regions neither close a door nor open a wall.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import csr_array

_STRIP = 1 << 20  # cells that are labelled at a time
_NEIGHBOURS = np.ones((3, 3), bool)  # diagonal ones count, as in the search over cells


@dataclass(frozen=True, slots=True, eq=False)
class RegionGraph:
    """Nodes at `points` (n, 2) in cells (row, column), and the cost of each step between neighbours, in cells.

    `points` are centres of regions, or whole numbers for cells.
    """

    points: NDArray[np.float64]
    steps: csr_array


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """The regions of blocks of `size` x `size` cells. `blocks` (n, 2) holds each region's block (row, column)."""

    graph: RegionGraph
    blocks: NDArray[np.int32]
    size: int
    shape: tuple[int, int]
    """The numbers of rows and columns of blocks."""
    costs: NDArray[np.uint8]
    free: NDArray[np.bool_]

    def region_of(self, cell: tuple[int, int]) -> int:
        """The region that holds a free cell. Raises StopIteration where its block was not asked for."""
        block = (cell[0] // self.size, cell[1] // self.size)
        first = int(np.flatnonzero((self.blocks == block).all(axis=1))[0])
        top, left = block[0] * self.size, block[1] * self.size
        part = self.free[self.costs[top : top + self.size, left : left + self.size]]
        labels, _ = label(part, _NEIGHBOURS)
        return first + int(labels[cell[0] - top, cell[1] - left]) - 1


def find_regions(
    costs: NDArray[np.uint8], weights: NDArray[np.float64], size: int, wanted: NDArray[np.bool_] | None = None
) -> Regions:
    """Cut costs (height, width) into blocks and find their regions, in the order of their blocks.

    `weights` (256) is the cost of a metre for each byte, inf where the robot must not go. Only blocks in `wanted`
    (rows, columns of blocks) are looked at.
    """
    height, width = costs.shape
    shape = (-(-height // size), -(-width // size))
    wanted = np.ones(shape, bool) if wanted is None else wanted
    free = np.isfinite(weights)
    finite = np.where(free, weights, 0.0).astype(np.float32)
    rows_at_once = max(1, _STRIP // (size * max(1, width)))
    numbers = np.full(shape, -1, np.int32)
    numbers[wanted] = np.arange(int(wanted.sum()), dtype=np.int32)
    borders: list[NDArray[np.int32]] = []
    places, loads, owners = [], [], []
    count = 0
    for top in range(0, shape[0], rows_at_once):
        chosen = np.argwhere(wanted[top : top + rows_at_once]).astype(np.int32)
        if not len(chosen):
            continue
        cells = _gather(costs, top, chosen, size, rows_at_once)
        labels = np.zeros((len(chosen), size + 1, size), np.int32)
        labels[:, :size] = free[cells]
        found = label(labels.reshape(-1, size), _NEIGHBOURS, output=labels.reshape(-1, size))
        owner, place, load = _describe(labels[:, :size], finite[cells], found)
        chosen[:, 0] += top
        places.append(place + chosen[owner] * size)
        loads.append(load)
        owners.append(chosen[owner])
        sides = np.stack((labels[:, 0], labels[:, size - 1], labels[:, :size, 0], labels[:, :size, -1]))
        borders.append(np.where(sides > 0, sides + np.int32(count), np.int32(0)))
        count += found
    centres = np.concatenate(places) if places else np.empty((0, 2))
    sides = np.concatenate(borders, axis=1) if borders else np.empty((4, 0, size), np.int32)
    pairs = _touching(sides, numbers, count)
    graph = _graph(centres, np.concatenate(loads) if loads else np.empty(0), pairs)
    return Regions(graph, np.concatenate(owners) if owners else np.empty((0, 2), np.int32), size, shape, costs, free)


def cell_graph(costs: NDArray[np.uint8], weights: NDArray[np.float64], cells: NDArray[np.int64]) -> RegionGraph:
    """The graph of single cells, numbers row * width + column (n) in ascending order, with eight neighbours each.

    A step costs its length times the mean weight of its two cells.
    """
    width = costs.shape[1]
    columns = cells % width
    pairs = []
    follows = np.flatnonzero((np.diff(cells) == 1) & (columns[1:] > 0))
    pairs.append(np.stack((follows, follows + 1)))
    for step in (-1, 0, 1):
        inside = np.flatnonzero((columns + step >= 0) & (columns + step < width))
        below = cells[inside] + width + step
        at = np.searchsorted(cells, below)
        there = at < len(cells)
        there[there] = cells[at[there]] == below[there]
        pairs.append(np.stack((inside[there], at[there])))
    places = np.stack((cells // width, columns), axis=-1).astype(np.float64)
    return _graph(places, weights[costs.reshape(-1)[cells]], np.concatenate(pairs, axis=1))


def _gather(costs: NDArray[np.uint8], top: int, chosen: NDArray[np.int32], size: int, rows: int) -> NDArray[np.uint8]:
    """The cells (n, size, size) of blocks, given relative to the block row `top`; beyond the border they are 254."""
    part = costs[top * size : (top + rows) * size]
    below, right = -part.shape[0] % size, -part.shape[1] % size
    if below or right:
        part = np.pad(part, ((0, below), (0, right)), constant_values=254)
    blocks = part.reshape(part.shape[0] // size, size, part.shape[1] // size, size)
    return blocks[chosen[:, 0], :, chosen[:, 1]]


def _describe(
    labels: NDArray[np.int32], weights: NDArray[np.float32], count: int
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Of `count` regions: the block that each is in (n), its centre in that block (n, 2), its mean weight (n).

    `labels` and `weights` (blocks, size, size); the labels ascend with the blocks, and weights are 0 where labels are.
    """
    blocks, size, _ = labels.shape
    last = np.maximum.accumulate(labels.reshape(blocks, -1).max(axis=1, initial=0))
    regions = np.diff(last, prepend=0)
    owner = np.repeat(np.arange(blocks), regions)
    row, column = np.divmod(np.arange(size * size, dtype=np.float32), np.float32(size))
    moments = np.stack((np.ones_like(row), row, column), axis=-1)
    sums = np.empty((count, 4))
    alone = regions == 1
    cells = (labels > 0).reshape(blocks, -1)
    sums[last[alone] - 1, :3] = cells[alone].astype(np.float32) @ moments
    sums[last[alone] - 1, 3] = weights.reshape(blocks, -1)[alone].sum(axis=1)
    several = np.flatnonzero(regions > 1)
    inside = np.flatnonzero(cells[several])
    which = labels[several].reshape(-1)[inside] - 1
    within = inside % (size * size)
    parts = np.concatenate([np.arange(last[k] - regions[k], last[k]) for k in several]) if len(several) else several
    for place, values in enumerate((*moments[within].T, weights[several].reshape(-1)[inside])):
        sums[parts, place] = np.bincount(which, values, count)[parts]
    sums[:, 1:] /= sums[:, :1]
    return owner, sums[:, 1:3], sums[:, 3]


def _touching(sides: NDArray[np.int32], numbers: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """The pairs (2, m) of regions that touch across borders of blocks.

    `sides` (4, n, size): the regions along the upper, lower, left and right side of each block, from 1 on, 0 for none.
    """
    upper, lower, left, right = sides
    found = []
    for one, other, here, there in (
        (right, left, numbers[:, :-1], numbers[:, 1:]),
        (lower, upper, numbers[:-1], numbers[1:]),
    ):
        both = (here >= 0) & (there >= 0)
        a, b = one[here[both]], other[there[both]]
        for first, second in ((a, b), (a[:, 1:], b[:, :-1]), (a[:, :-1], b[:, 1:])):
            found.append(_distinct(first, second, count))
    for side, here, there in (
        ((-1, 0), numbers[:-1, :-1], numbers[1:, 1:]),
        ((0, -1), numbers[:-1, 1:], numbers[1:, :-1]),
    ):
        both = (here >= 0) & (there >= 0)
        found.append(_distinct(lower[here[both]][:, side[0], None], upper[there[both]][:, side[1], None], count))
    keys = np.sort(np.concatenate(found))
    keys = keys[np.diff(keys, prepend=-1) > 0]
    return np.stack((keys // (count + 1), keys % (count + 1))) - 1


def _distinct(a: NDArray[np.int32], b: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """Keys of the pairs of regions in two arrays (n, m); those that follow each other in a row only once."""
    new = (a > 0) & (b > 0)
    new[:, 1:] &= (a[:, 1:] != a[:, :-1]) | (b[:, 1:] != b[:, :-1])
    return a[new].astype(np.int64) * (count + 1) + b[new]


def _graph(places: NDArray[np.float64], loads: NDArray[np.float64], pairs: NDArray[np.int64]) -> RegionGraph:
    a, b = pairs
    costs = np.hypot(*(places[a] - places[b]).T) * 0.5 * (loads[a] + loads[b])
    count = len(places)
    ends = (np.concatenate((a, b)), np.concatenate((b, a)))
    return RegionGraph(places, csr_array((np.concatenate((costs, costs)), ends), shape=(count, count)))
