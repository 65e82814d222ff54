"""The truth about a world: its reachable floor, what a lidar sees in it, and the shortest ways."""

import math

import numpy as np
from bench.navigation_parts.geodesic import free_cells
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.exploration.search.floor import drive_distances, nearest_cell
from ur_nodes.geometry.grid import Grid

_BEAMS = 360
_REACH = 12.0  # m
_BESIDE = 8.0  # cells


class Truth:
    """A world for a round robot of `radius` m that begins at the origin.

    `floor` (height, width) is the reachable floor: all cells that the robot's disc covers somewhere.
    """

    def __init__(self, grid: Grid, radius: float) -> None:
        self.grid = grid
        self.walls = grid.values >= 65
        self.fits = free_cells(grid, radius)
        start = nearest_cell(grid, self.fits, (0.0, 0.0), 0.5)
        if start is None:
            raise SystemExit("error: the robot does not fit at the start of the world")
        self.start = start
        centres = np.isfinite(drive_distances(self.fits, start, grid.resolution))
        self.floor = (distance_transform_edt(~centres) * grid.resolution <= radius) & ~self.walls

    def ranges(self, x: float, y: float, yaw: float = 0.0) -> NDArray[np.float64]:
        """What a lidar at a place measures: (beams) in m over the full turn, inf beyond its reach."""
        step = 0.5 * self.grid.resolution
        angles = yaw + np.arange(_BEAMS) * (2.0 * math.pi / _BEAMS)
        steps = np.arange(step, _REACH, step)
        points = np.stack((x + steps * np.cos(angles)[:, None], y + steps * np.sin(angles)[:, None]), axis=-1)
        hit = self.grid.values_at(points, outside=100) >= 65
        first = hit.argmax(axis=1)
        ranges: NDArray[np.float64] = np.where(hit.any(axis=1), steps[first], np.inf)
        return ranges

    def sees(self, x: float, y: float) -> NDArray[np.bool_]:
        """The cells (height, width) that beams pass, of a lidar at a place."""
        step = 0.5 * self.grid.resolution
        ranges = np.minimum(self.ranges(x, y), _REACH)
        angles = np.arange(_BEAMS) * (2.0 * math.pi / _BEAMS)
        steps = np.arange(0.0, _REACH, step)
        points = np.stack((x + steps * np.cos(angles)[:, None], y + steps * np.sin(angles)[:, None]), axis=-1)
        cells = self.grid.cells_of_points(points[steps[None] < ranges[:, None]])
        cells = cells[self.grid.contains(cells)]
        seen = np.zeros(self.walls.shape, bool)
        seen[cells[:, 0], cells[:, 1]] = True
        return seen


def greedy_way(truth: Truth, share: float) -> float:
    """The way (m) of an explorer that knows the map, and drives to the nearest floor that it has not seen yet.

    It looks every 0.25 m and ends when it has seen a `share` of the reachable floor.
    """
    from skimage.graph import MCP_Geometric

    cell, way = truth.start, 0.0
    seen = truth.sees(*truth.grid.points_of_cells(np.array(cell)).tolist())
    total = int(truth.floor.sum())
    stride = max(1, round(0.25 / truth.grid.resolution))
    while (seen & truth.floor).sum() < share * total:
        search = MCP_Geometric(np.where(truth.fits, 1.0, -1.0))
        costs, _ = search.find_costs([cell])
        # Floor beside the walls has no cell where the robot's centre fits: the nearest such cell stands for it.
        left = truth.floor & ~seen
        targets = left & np.isfinite(costs)
        if not targets.any():
            targets = (distance_transform_edt(~left) <= _BESIDE) & np.isfinite(costs)
        spots = np.argwhere(targets)
        target = spots[int(np.argmin(costs[targets]))]
        path = search.traceback(tuple(target.tolist()))[: stride + 1]
        before = costs[cell]
        cell = path[-1]
        way += float(costs[cell] - before) * truth.grid.resolution
        if len(path) < 2:  # it is there and does not see it: from here nobody does
            seen |= left & _near(left, cell)
        seen |= truth.sees(*truth.grid.points_of_cells(np.array(cell)).tolist())
    return way


def _near(mask: NDArray[np.bool_], cell: tuple[int, int], cells: int = 8) -> NDArray[np.bool_]:
    near = np.zeros(mask.shape, bool)
    near[max(0, cell[0] - cells) : cell[0] + cells + 1, max(0, cell[1] - cells) : cell[1] + cells + 1] = True
    return near
