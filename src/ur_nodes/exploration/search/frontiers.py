"""Frontiers: the edges between known free floor and unknown space, joined to groups, each with what may lie behind."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_opening, distance_transform_edt, find_objects, label, uniform_filter

from ur_nodes.exploration.search.floor import Floor

_AROUND = 0.4  # m: cells of a wall so near, along either axis, tell its direction
_FEWEST = 5  # cells of a wall whose direction is known
_STRAIGHT = 0.1  # variance across a wall, as a share of that along it, at most
_AT_END = 0.3  # of `_AROUND`: how far the middle of the cells near an end lies away from it, at least
CONTINUED = 2.0
"""The length (m) by which a wall is continued."""


def continue_walls(floor: Floor, length: float = CONTINUED) -> NDArray[np.bool_]:
    """Unknown cells (height, width) that a straight wall runs into: there is probably a wall, too.

    A wall is continued by at most `length` m, and never beyond known floor. Corners and round things are not.
    """
    continued = np.zeros(floor.shape, bool)
    starts, directions = _ends(floor)
    if not len(starts):
        return continued
    steps = np.arange(1, math.ceil(length / floor.resolution) + 1)
    cells = np.rint(starts[:, None] + steps[:, None] * directions[:, None]).astype(np.intp)
    height, width = floor.shape
    inside = ((cells >= 0) & (cells < (height, width))).all(axis=-1)
    rows, columns = np.clip(cells[..., 0], 0, height - 1), np.clip(cells[..., 1], 0, width - 1)
    passed = np.logical_and.accumulate(inside & ~floor.free[rows, columns], axis=1)
    passed &= floor.unknown[rows, columns]
    continued[rows[passed], columns[passed]] = True
    return continued


def _ends(floor: Floor) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The cells (n, 2) at ends of straight walls, and unit vectors (n, 2) in cells that lead on from there."""
    cells = np.argwhere(floor.occupied)
    if not len(cells):
        return cells, np.zeros((0, 2))
    side = 2 * max(2, round(_AROUND / floor.resolution)) + 1
    wall = floor.occupied.astype(np.float64)
    row, column = np.indices(floor.shape, dtype=np.float64)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        sums = uniform_filter(values * wall, side, mode="constant")[floor.occupied]
        means: NDArray[np.float64] = sums / shares
        return means

    shares = uniform_filter(wall, side, mode="constant")[floor.occupied]
    middle = np.column_stack((mean(row), mean(column)))
    rows = mean(row * row) - middle[:, 0] ** 2
    columns = mean(column * column) - middle[:, 1] ** 2
    mixed = mean(row * column) - middle[:, 0] * middle[:, 1]
    spread = np.hypot(rows - columns, 2.0 * mixed)
    along, across = 0.5 * (rows + columns + spread), 0.5 * (rows + columns - spread)
    angle = 0.5 * np.arctan2(2.0 * mixed, columns - rows)  # from the columns' axis
    directions = np.column_stack((np.sin(angle), np.cos(angle)))
    lead = ((cells - middle) * directions).sum(axis=1)
    end = (shares * side**2 > _FEWEST - 0.5) & (across <= _STRAIGHT * along)
    end &= np.abs(lead) >= _AT_END * (side // 2)
    return cells[end], directions[end] * np.sign(lead[end])[:, None]


_SPECKLE = 3  # cells: unknown places narrower than this are gaps between two beams, not rooms
_DEPTH = 2.0  # m: unknown space so far behind a frontier is its gain
_LONGEST = 3.0  # m: longer frontiers are cut into pieces
_CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], bool)


@dataclass(frozen=True, slots=True, eq=False)
class Frontier:
    """Cells (n, 2) of free floor beside unknown space, as rows and columns. `size` in m, `gain` in m2.

    `middle` (2) is the cell nearest to the middle, and `point` its centre, m. `hidden` are the cells behind it, each
    as one number; other frontiers may have the same ones.
    """

    cells: NDArray[np.intp]
    middle: NDArray[np.intp]
    point: tuple[float, float]
    size: float
    gain: float
    hidden: frozenset[int] = frozenset()


def frontier_cells(floor: Floor) -> NDArray[np.bool_]:
    """Free cells that touch unknown space wider than a gap between beams."""
    beyond = np.pad(floor.unknown, _SPECKLE, constant_values=True)  # nothing is known outside of the grid
    wide = binary_dilation(binary_opening(beyond, np.ones((_SPECKLE, _SPECKLE), bool)), _CROSS)
    edge: NDArray[np.bool_] = floor.free & wide[_SPECKLE:-_SPECKLE, _SPECKLE:-_SPECKLE]
    return edge


def find_frontiers(floor: Floor, smallest: float) -> tuple[Frontier, ...]:
    """The frontiers of at least `smallest` m, the longest first."""
    edge = frontier_cells(floor)
    walls = floor.occupied | continue_walls(floor)
    centres = distance_transform_edt(~walls) * floor.resolution > floor.radius
    groups, _ = label(edge, np.ones((3, 3), bool))
    found: list[Frontier] = []
    for number, box in enumerate(find_objects(groups), start=1):
        cells = np.argwhere(groups[box] == number) + np.array([part.start for part in box])
        if len(cells) * floor.resolution < smallest:
            continue
        found.extend(_frontier(floor, piece, walls, centres) for piece in _cut(cells, floor.resolution))
    return tuple(sorted(found, key=lambda each: (-each.size, each.point)))


def unknown_behind(floor: Floor, frontiers: tuple[Frontier, ...]) -> float:
    """The unknown space near the frontiers, m2, each cell once: an estimate of the floor that is left."""
    if not frontiers:
        return 0.0
    near = np.ones(floor.shape, bool)
    for each in frontiers:
        near[each.cells[:, 0], each.cells[:, 1]] = False
    close = distance_transform_edt(near) * floor.resolution <= _DEPTH
    return float((close & floor.unknown).sum()) * floor.resolution**2


def _cut(cells: NDArray[np.intp], resolution: float) -> list[NDArray[np.intp]]:
    """Pieces of a long frontier, by halves across its longer side."""
    spans = np.ptp(cells, axis=0)
    axis = int(np.argmax(spans))
    if (spans[axis] + 1) * resolution <= _LONGEST:
        return [cells]
    half = cells[:, axis] <= (cells[:, axis].min() + cells[:, axis].max()) // 2
    return [*_cut(cells[half], resolution), *_cut(cells[~half], resolution)]


def _frontier(floor: Floor, cells: NDArray[np.intp], walls: NDArray[np.bool_], centres: NDArray[np.bool_]) -> Frontier:
    middle = cells[int(np.argmin(np.hypot(*(cells - cells.mean(axis=0)).T)))]
    size = len(cells) * floor.resolution
    hidden = _hidden_floor(floor, cells, walls, centres)
    gain = min(len(hidden) * floor.resolution**2, size**2)  # a narrow gap hides a corner, not a room
    x, y = floor.points_of_cells(middle)
    return Frontier(cells, middle, (float(x), float(y)), size, gain, frozenset((hidden @ (floor.shape[1], 1)).tolist()))


def _hidden_floor(
    floor: Floor, cells: NDArray[np.intp], walls: NDArray[np.bool_], centres: NDArray[np.bool_]
) -> NDArray[np.intp]:
    """The cells (n, 2) of unknown floor near a frontier that the robot's disc may cover when it drives on there.

    `walls` (height, width): the occupied cells, and those where a wall probably goes on. `centres` (height, width): the
    cells where the middle of the robot has room among them.
    """
    reach = math.ceil(_DEPTH / floor.resolution)
    low = np.maximum(cells.min(axis=0) - reach, 0)
    high = np.minimum(cells.max(axis=0) + reach + 1, floor.shape)
    box = (slice(low[0], high[0]), slice(low[1], high[1]))
    away = np.ones((high - low).tolist(), bool)
    away[tuple((cells - low).T)] = False
    apart = distance_transform_edt(away) * floor.resolution
    hidden = floor.unknown[box] & (apart <= _DEPTH)
    begin = floor.reachable[box] & (apart <= floor.radius + 3 * floor.resolution)
    if not begin.any():  # the robot does not get there; what it would find is measured all the same
        covered = _connected(hidden & ~walls[box], ~away)
    else:
        reached = _connected(hidden & centres[box], begin)
        covered = distance_transform_edt(~reached) * floor.resolution <= floor.radius
    found: NDArray[np.intp] = np.argwhere(covered & hidden) + low
    return found


def _connected(mask: NDArray[np.bool_], begin: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The cells (height, width) of a mask that are connected to those of `begin`, and the latter."""
    groups, _ = label(mask | begin)
    found: NDArray[np.bool_] = np.isin(groups, np.unique(groups[begin]))
    return found
