"""Occupancy grids: what a map server gives out and what localisation and navigation work on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur.worlds.map_file import FREE, OCCUPIED, UNKNOWN
from ur_nodes.geometry.pose import Pose2

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "Grid"]


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Occupancy per square cell of the plane.

    `values` is int8 (height, width): -1 unknown, 0 free to 100 occupied; the array is not to be written to. Row 0,
    column 0 is the cell whose corner is `origin`: columns run along the origin's x axis, rows along its y axis.
    `resolution` is the side of a cell in m; `origin` is a pose in the frame of the map (REP 103).
    """

    values: NDArray[np.int8]
    resolution: float
    origin: Pose2

    @property
    def height(self) -> int:
        """The number of rows."""
        return int(self.values.shape[0])

    @property
    def width(self) -> int:
        """The number of columns."""
        return int(self.values.shape[1])

    def cells_of_points(self, points: NDArray[np.floating]) -> NDArray[np.intp]:
        """The cells (..., 2) as (row, column) that hold points (..., 2) as (x, y) in m; may lie outside the grid."""
        cells: NDArray[np.intp] = np.floor(self.fractions_of_points(points)).astype(np.intp)
        return cells

    def fractions_of_points(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """As cells_of_points, with fractions: the centre of cell (r, c) is (r + 0.5, c + 0.5)."""
        dx = points[..., 0] - self.origin.x
        dy = points[..., 1] - self.origin.y
        if self.origin.yaw:
            c, s = math.cos(self.origin.yaw), math.sin(self.origin.yaw)
            dx, dy = c * dx + s * dy, c * dy - s * dx
        fractions: NDArray[np.float64] = np.stack((dy, dx), axis=-1).astype(np.float64) / self.resolution
        return fractions

    def points_of_cells(self, cells: NDArray[np.integer] | NDArray[np.floating]) -> NDArray[np.float64]:
        """The centres (..., 2) as (x, y) in m of cells (..., 2) as (row, column)."""
        along = (np.asarray(cells[..., 1], dtype=np.float64) + 0.5) * self.resolution
        across = (np.asarray(cells[..., 0], dtype=np.float64) + 0.5) * self.resolution
        c, s = math.cos(self.origin.yaw), math.sin(self.origin.yaw)
        return np.stack((self.origin.x + c * along - s * across, self.origin.y + s * along + c * across), axis=-1)

    def contains(self, cells: NDArray[np.integer]) -> NDArray[np.bool_]:
        """Which of the cells (..., 2) lie inside the grid."""
        rows, columns = cells[..., 0], cells[..., 1]
        return (rows >= 0) & (rows < self.height) & (columns >= 0) & (columns < self.width)

    def values_at(self, points: NDArray[np.floating], outside: int = UNKNOWN) -> NDArray[np.int8]:
        """The values (...) below points (..., 2) in m; `outside` where the grid does not reach."""
        cells = self.cells_of_points(points)
        inside = self.contains(cells)
        rows = np.where(inside, cells[..., 0], 0)
        columns = np.where(inside, cells[..., 1], 0)
        return np.where(inside, self.values[rows, columns], np.int8(outside)).astype(np.int8)

    def same_frame(self, other: Grid) -> bool:
        """Whether both have the same shape, resolution and origin, so that cells mean the same places."""
        return (
            self.values.shape == other.values.shape
            and self.resolution == other.resolution
            and self.origin == other.origin
        )
