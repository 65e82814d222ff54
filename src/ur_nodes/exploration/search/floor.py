"""The floor of a growing map: known, free, wide enough for the robot, and how far each place is to drive."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from skimage.graph import MCP_Geometric

from ur.worlds.cells import CellFrame
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

OCCUPIED_FROM = 65
"""The least occupancy (of 100) of an obstacle; the limit that the costmaps use."""

ESCAPE = 0.5
"""The distance (m) that the robot may have from the next place where it fits."""

_FAR = 1e6  # m, the clearance of a map without an obstacle

Cell = tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Floor(CellFrame):
    """Masks (height, width) over the cells of a map.

    `free`, `unknown` and `occupied` exclude each other; the last holds obstacles, too. `clearance` is the distance in m
    from the nearest occupied cell, centre to centre. `fits`: the centre of the robot may be there. `distance` is the
    way in m that the robot drives to a cell; inf where it does not get to.
    """

    resolution: float
    origin: Pose2
    free: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    occupied: NDArray[np.bool_]
    clearance: NDArray[np.float64]
    fits: NDArray[np.bool_]
    distance: NDArray[np.float64]
    radius: float

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of rows and columns."""
        height, width = self.free.shape
        return height, width

    @property
    def reachable(self) -> NDArray[np.bool_]:
        """The cells that the robot gets to."""
        reached: NDArray[np.bool_] = np.isfinite(self.distance)
        return reached

    @property
    def known(self) -> float:
        """The known free floor, m2."""
        return float(np.count_nonzero(self.free)) * self.resolution**2

    def cell(self, x: float, y: float) -> Cell:
        """The cell of a place; may lie outside."""
        row, column = self.cells_of_points(np.array((x, y)))
        return int(row), int(column)

    def point(self, cell: Cell) -> tuple[float, float]:
        """The centre of a cell, m."""
        x, y = self.points_of_cells(np.array(cell))
        return float(x), float(y)


def read_floor(grid: Grid, robot: Pose2, radius: float, obstacles: NDArray[np.floating] | None = None) -> Floor:
    """Read the floor of a map as it is for a round robot of `radius` m at a pose in the map's frame.

    `obstacles` (n, 2) in m are occupied, too: what sensors see now and the map does not show.
    """
    values = grid.values
    occupied = values >= OCCUPIED_FROM
    if obstacles is not None and len(obstacles):
        cells = grid.cells_of_points(obstacles)
        cells = cells[grid.contains(cells)]
        occupied = occupied.copy()
        occupied[cells[:, 0], cells[:, 1]] = True
    unknown = (values < 0) & ~occupied
    free = ~unknown & ~occupied
    clearance = np.full(values.shape, _FAR)
    if occupied.any():
        clearance = distance_transform_edt(~occupied) * grid.resolution
    fits = free & (clearance > radius)
    distance = _distances(grid, fits, robot)
    return Floor(grid.resolution, grid.origin, free, unknown, occupied, clearance, fits, distance, radius)


def drive_distances(fits: NDArray[np.bool_], start: Cell, resolution: float) -> NDArray[np.float64]:
    """Ways in m (height, width) over cells that fit from one of them; inf where there is none."""
    costs, _ = MCP_Geometric(np.where(fits, 1.0, -1.0)).find_costs([start])
    lengths: NDArray[np.float64] = costs * resolution
    return lengths


def _distances(grid: Grid, fits: NDArray[np.bool_], robot: Pose2) -> NDArray[np.float64]:
    start = nearest_cell(grid, fits, (robot.x, robot.y), ESCAPE)
    if start is None:
        return np.full(fits.shape, np.inf)
    return drive_distances(fits, start, grid.resolution)


def nearest_cell(frame: CellFrame, mask: NDArray[np.bool_], point: tuple[float, float], reach: float) -> Cell | None:
    """The cell of a mask that is nearest to a place, at most `reach` m away; None when there is none."""
    row, column = np.floor(frame.fractions_of_points(np.array(point)))
    steps = math.ceil(reach / frame.resolution)
    rows = slice(max(0, int(row) - steps), max(0, int(row) + steps + 1))
    columns = slice(max(0, int(column) - steps), max(0, int(column) + steps + 1))
    cells = np.argwhere(mask[rows, columns]) + np.array((rows.start, columns.start))
    if not len(cells):
        return None
    away = np.hypot(*(frame.points_of_cells(cells) - point).T)
    best = int(np.argmin(away))
    return (int(cells[best, 0]), int(cells[best, 1])) if away[best] <= reach + frame.resolution else None
