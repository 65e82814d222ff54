"""Square cells of a plane: the cell of a point, the point of a cell, and the values at points."""

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

UNKNOWN = -1
FREE = 0
OCCUPIED = 100

Value = TypeVar("Value", bound=np.generic)
_STRIP = 1 << 17  # cells


class CellFrame:
    """The geometry of a grid, for every class with a resolution, an origin and an array of values.

    Row 0, column 0 is the cell whose outer corner is `origin`, a pose x, y, yaw (m, m, rad) in the frame of the grid.
    Columns run along the origin's x axis, rows along its y axis. `resolution` is the side of a cell in m.
    """

    __slots__ = ()

    resolution: float
    origin: tuple[float, float, float]

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of rows and columns."""
        raise NotImplementedError

    @property
    def height(self) -> int:
        """The number of rows."""
        return self.shape[0]

    @property
    def width(self) -> int:
        """The number of columns."""
        return self.shape[1]

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Return the smallest axis-aligned box around the grid: left, bottom, right, top in m."""
        corners = np.array([(row, column) for row in (0, self.height) for column in (0, self.width)]) - 0.5
        points = self.points_of_cells(corners)
        (left, bottom), (right, top) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return left, bottom, right, top

    def fractions_of_points(self, points: NDArray[np.floating]) -> NDArray[Any]:
        """Return the fractional (row, column) of points (..., 2), x, y in m; the centre of cell (r, c) is at + 0.5."""
        rows, columns = self.fractions_at(points[..., 0], points[..., 1])
        fractions = np.empty((*rows.shape, 2), rows.dtype)
        fractions[..., 0], fractions[..., 1] = rows, columns
        return fractions

    def fractions_at(self, xs: NDArray[np.floating], ys: NDArray[np.floating]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the fractional rows and columns (...) of points with coordinates (...) in m."""
        x, y, yaw = self.origin
        dx, dy = xs - x, ys - y
        if yaw:
            c, s = math.cos(yaw), math.sin(yaw)
            dx, dy = c * dx + s * dy, c * dy - s * dx
        return dy / self.resolution, dx / self.resolution

    def cells_of_points(self, points: NDArray[np.floating]) -> NDArray[np.intp]:
        """Return the cells (..., 2), (row, column), of points (..., 2), x, y in m; they may be outside the grid."""
        return self.cells_at(points[..., 0], points[..., 1])

    def cells_at(self, xs: NDArray[np.floating], ys: NDArray[np.floating]) -> NDArray[np.intp]:
        """Return the cells (..., 2), (row, column), of points with coordinates (...) in m, as `cells_of_points`."""
        rows, columns = self.fractions_at(xs, ys)
        cells = np.empty((*rows.shape, 2), np.intp)
        cells[..., 0], cells[..., 1] = np.floor(rows), np.floor(columns)
        return cells

    def points_of_cells(self, cells: NDArray[np.integer] | NDArray[np.floating]) -> NDArray[np.float64]:
        """Return the centres (..., 2), (x, y) in m, of cells (..., 2), (row, column)."""
        x, y, yaw = self.origin
        along = (np.asarray(cells[..., 1], dtype=np.float64) + 0.5) * self.resolution
        across = (np.asarray(cells[..., 0], dtype=np.float64) + 0.5) * self.resolution
        c, s = math.cos(yaw), math.sin(yaw)
        return np.stack((x + c * along - s * across, y + s * along + c * across), axis=-1)

    def contains(self, cells: NDArray[np.integer]) -> NDArray[np.bool_]:
        """Return True for cells (..., 2) inside of the grid."""
        rows, columns = cells[..., 0], cells[..., 1]
        height, width = self.shape
        inside: NDArray[np.bool_] = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        return inside


def look_up(frame: CellFrame, values: NDArray[Value], points: NDArray[np.floating], outside: Any) -> NDArray[Value]:
    """Return the values (...) at points (..., 2) in m; `outside` beyond the grid."""
    rows, columns = (np.floor(each).astype(np.int32) for each in frame.fractions_at(points[..., 0], points[..., 1]))
    inside = (rows >= 0) & (rows < frame.height) & (columns >= 0) & (columns < frame.width)
    if inside.all():
        below: NDArray[Value] = values[rows, columns]
        return below
    found = values[np.where(inside, rows, 0), np.where(inside, columns, 0)]
    return np.where(inside, found, values.dtype.type(outside))


def translate_cells(cells: NDArray[Any], table: NDArray[Value]) -> NDArray[Value]:
    """Replace each byte of an array (n, ...) by its entry of a table of 256; negative bytes count from its end.

    It works in strips, since an index of numpy takes eight bytes per cell.
    """
    result = np.empty(cells.shape, table.dtype)
    codes = cells.view(np.uint8)
    rows = max(1, _STRIP // max(1, math.prod(cells.shape[1:])))
    for start in range(0, len(codes), rows):
        np.take(table, codes[start : start + rows], out=result[start : start + rows], mode="clip")
    return result
