"""Reachable viewpoints: poses from which a frontier is visible."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.exploration.search.floor import Cell, Floor
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.geometry.pose import Pose2

DISTANCES = (1.0, 0.5, 0.25, 2.5)
"""Distances (m) from a frontier that are tried, one after the other, until it is seen."""

_ARRIVAL = 0.4  # m
_TRIED = 150  # candidates whose line of sight is checked


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A pose that looks at a frontier, and the `distance` (m) to drive there."""

    pose: Pose2
    cell: Cell
    distance: float
    frontier: Frontier


def find_viewpoint(
    floor: Floor, frontier: Frontier, reach: float, clearance: float = 0.0, *, whole: bool = True, facing: bool = False
) -> Viewpoint | None:
    """The place nearest to drive to, at most `reach` m from the frontier and in sight of it; None: none is.

    That is from and of any of its cells, or with `whole` false its middle one. Its `clearance` is at least
    so many m. The robot faces the way that it arrives, so that it need not turn there; with `facing` the frontier.
    """
    cells = frontier.cells if whole else frontier.middle[None]
    margin = math.ceil(reach / floor.resolution) + 1
    low = np.maximum(cells.min(axis=0) - margin, 0)
    high = np.minimum(cells.max(axis=0) + margin + 1, floor.shape)
    box = (slice(low[0], high[0]), slice(low[1], high[1]))
    apart, nearest = _distances_to(cells - low, (high - low).tolist())
    near = np.isfinite(floor.distance[box]) & (apart * floor.resolution <= reach) & (floor.clearance[box] >= clearance)
    spots = np.argwhere(near)
    if not len(spots):
        return None
    lengths = floor.distance[box][near]
    order = np.argsort(lengths, kind="stable")
    chosen = spots[order[:: max(1, len(order) // _TRIED)]]
    targets = nearest[:, chosen[:, 0], chosen[:, 1]].T
    seen = _in_sight(floor, chosen + low, targets + low)
    if not seen.any():
        return None
    first = int(np.argmax(seen))
    row, column = (chosen[first] + low).tolist()
    x, y = floor.point((row, column))
    to_x, to_y = floor.points_of_cells(targets[first] + low)
    turned = facing and (to_x, to_y) != (x, y)
    yaw = math.atan2(to_y - y, to_x - x) if turned else _arrival(floor, (row, column))
    return Viewpoint(Pose2(x, y, yaw), (row, column), float(floor.distance[row, column]), frontier)


def _distances_to(cells: NDArray[np.intp], shape: list[int]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """For each cell of a box the distance to the nearest of some cells (n, 2), in cells, and which that is."""
    if len(cells) == 1:
        rows, columns = np.ogrid[: shape[0], : shape[1]]
        row, column = cells[0].tolist()
        apart = np.sqrt((rows - row) ** 2 + (columns - column) ** 2)
        return apart, np.broadcast_to(cells[0][:, None, None], (2, *shape))
    away = np.ones(shape, bool)
    away[tuple(cells.T)] = False
    apart, nearest = distance_transform_edt(away, return_indices=True)
    return apart, nearest


def next_viewpoint(floor: Floor, frontier: Frontier, looks: int, room: float) -> Viewpoint | None:
    """A place to see the frontier from, after so many that showed nothing new; None when there is no further one.

    Places with `room` m around them come first: there the robot can turn.
    """
    wide = room + floor.resolution
    for reach in DISTANCES[looks:]:
        for whole, clearance in ((False, wide), (False, 0.0), (True, wide), (True, 0.0)):
            found = find_viewpoint(floor, frontier, reach, clearance, whole=whole, facing=looks > 0)
            if found is not None:
                return found
    return None


def _arrival(floor: Floor, cell: Cell) -> float:
    """The direction (rad) in which the robot arrives at a cell."""
    around = round(_ARRIVAL / floor.resolution)
    rows, columns = (slice(max(0, at - around), at + around + 1) for at in cell)
    lengths = floor.distance[rows, columns]
    before = np.unravel_index(int(np.argmin(lengths)), lengths.shape)
    back, left = rows.start + before[0] - cell[0], columns.start + before[1] - cell[1]
    return math.atan2(-back, -left) + floor.origin[2] if back or left else floor.origin[2]


def _in_sight(floor: Floor, spots: NDArray[np.intp], targets: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Test straight lines between pairs (n, 2) of cells: True where all cells on the line are free."""
    count = 2 * int(np.abs(targets - spots).max()) + 1
    shares = np.linspace(0.0, 1.0, count)[:, None, None]
    lines = np.rint(spots + shares * (targets - spots)).astype(np.intp)
    free: NDArray[np.bool_] = np.all(floor.free[lines[..., 0], lines[..., 1]], axis=0)
    return free
