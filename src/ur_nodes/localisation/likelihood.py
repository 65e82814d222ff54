"""The likelihood field: the distance of beams' ends to walls of the map, and the likelihood of a scan.

Source: Thrun, Burgard, Fox, Probabilistic Robotics, section 6.4.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.distance import squared_distances
from ur_nodes.geometry.grid import FREE, Grid
from ur_nodes.geometry.sparse_array import sparse_zeros

OCCUPIED_FROM = 65  # of 100: what counts as a wall in maps with values between
WHOLE = 1_000_000  # cells of a map that is prepared as a whole
_ROWS, _COLUMNS = 128, 512  # cells of a tile of a larger one; rows of a tile are half a page of memory
_KEPT = 100  # tiles; with more, those that are not needed are forgotten
_FARTHEST = 180  # cells


@dataclass(frozen=True, slots=True)
class BeamModel:
    """The model of a range: shares of hits and of random readings, spread `sigma_hit` and upper limit in m."""

    z_hit: float
    z_rand: float
    sigma_hit: float
    max_distance: float


class LikelihoodField:
    """A map prepared for localisation: a small one as a whole, a large one in tiles where beams end.

    `distances` float32 (height + 2, width + 2), m: from a cell's centre to the nearest wall's surface, negative inside
    walls, at most `model.max_distance`, +max_distance everywhere on a map without walls. `log_hits` float32, same size:
    the logarithm of a beam's likelihood when it ends in that cell. Both have a border of one cell that represents
    everything outside, where ends are random. Both hold only where `cover` was called,
    or everywhere if `complete`. Cells of at least 65 are walls.
    """

    def __init__(self, grid: Grid, model: BeamModel, whole: int = WHOLE) -> None:
        """A grid of at most `whole` cells is prepared as a whole."""
        self.grid = grid
        self.model = model
        height, width = grid.height + 2, grid.width + 2
        self._reach = min(_FARTHEST, math.ceil(model.max_distance / grid.resolution) + 2)
        self._tiles = np.zeros((-(-height // _ROWS), -(-width // _COLUMNS)), bool)
        self._free = np.zeros(grid.height + 1, np.int64)  # the free cells before each row
        for row, values in enumerate(grid.values):
            self._free[row + 1] = self._free[row] + np.count_nonzero(values == FREE)
        self.distances: NDArray[np.float32]
        self.log_hits: NDArray[np.float32]
        self._forget()
        if grid.values.size <= whole:
            self._work_out(0, 0, height, width)
            self._tiles[:] = True
        self.complete = bool(self._tiles.all())

    @property
    def free_count(self) -> int:
        """The number of free cells of the grid."""
        return int(self._free[-1])

    def free_cells(self, numbers: NDArray[np.integer]) -> NDArray[np.intp]:
        """Return the (row, column) (n, 2) of free cells by their numbers (n), which are counted along rows."""
        rows = np.searchsorted(self._free, numbers, side="right") - 1
        columns = np.empty(len(rows), np.intp)
        order = np.argsort(rows, kind="stable")
        for part in np.split(order, np.flatnonzero(np.diff(rows[order])) + 1) if len(rows) else ():
            row = int(rows[part[0]])
            columns[part] = np.flatnonzero(self.grid.values[row] == FREE)[numbers[part] - self._free[row]]
        return np.stack((rows, columns), axis=-1)

    def cover(self, rows: NDArray[np.integer], columns: NDArray[np.integer]) -> None:
        """Prepare the tables at cells given by rows and columns (of the same shape), all inside the map."""
        if self.complete or not rows.size:
            return
        first, last = (int(rows.min()) // _ROWS, int(columns.min()) // _COLUMNS), (int(rows.max()), int(columns.max()))
        box = (slice(first[0], last[0] // _ROWS + 1), slice(first[1], last[1] // _COLUMNS + 1))
        if self._tiles[box].all():
            return
        wanted = np.zeros_like(self._tiles)
        wanted[rows // _ROWS, columns // _COLUMNS] = True
        if np.count_nonzero(self._tiles | wanted) > _KEPT > 2 * np.count_nonzero(wanted):
            self._forget()
        for row, column in np.argwhere(wanted & ~self._tiles).tolist():
            self._work_out(row * _ROWS, column * _COLUMNS, (row + 1) * _ROWS, (column + 1) * _COLUMNS)
        self._tiles |= wanted

    def _forget(self) -> None:
        shape = (self.grid.height + 2, self.grid.width + 2)
        self.distances, self.log_hits = sparse_zeros(shape, np.float32), sparse_zeros(shape, np.float32)
        self._tiles[:] = False

    def _work_out(self, top: int, left: int, bottom: int, right: int) -> None:
        """Fill rows and columns of the tables, counted from the border."""
        model, reach = self.model, self._reach
        height, width = self.grid.shape
        upper, before = max(0, top - 1 - reach), max(0, left - 1 - reach)
        values = self.grid.values[upper : bottom - 1 + reach, before : right - 1 + reach]
        exact = np.full((min(bottom, height + 2) - top, min(right, width + 2) - left), model.max_distance)
        rows, columns = slice(max(top, 1), min(bottom, height + 1)), slice(max(left, 1), min(right, width + 1))
        if rows.start < rows.stop and columns.start < columns.stop:
            signed = signed_distances(values >= OCCUPIED_FROM, self.grid.resolution, reach)
            inner = (
                slice(rows.start - 1 - upper, rows.stop - 1 - upper),
                slice(columns.start - 1 - before, columns.stop - 1 - before),
            )
            exact[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left] = signed[inner]
        distances = np.clip(exact, -model.max_distance, model.max_distance).astype(np.float32)
        self.distances[top:bottom, left:right] = distances
        # The log likelihood of beams that end so far (m) from a wall: 0 for a sure hit, bounded below by z_rand
        hit = model.z_hit * np.exp(-0.5 * np.square(np.maximum(distances, 0.0) / model.sigma_hit))
        floor = max(model.z_rand, 1e-6)
        result: NDArray[np.float64] = np.log((hit + floor) / (model.z_hit + floor))
        self.log_hits[top:bottom, left:right] = result


def make_field(grid: Grid, model: BeamModel) -> LikelihoodField:
    """The likelihood field of a grid."""
    return LikelihoodField(grid, model)


def signed_distances(walls: NDArray[np.bool_], resolution: float, reach: int = _FARTHEST) -> NDArray[np.float64]:
    """Return each cell's distance (height, width) in m to the nearest wall surface.

    It is negative inside walls, and inf without walls. Half a cell is subtracted from the distance between centres, so
    that the value is 0 on the edge between a wall cell and its free neighbour and continuous across it. Exact up to
    `reach` cells (at most 180), beyond them larger.
    """
    if not walls.any():
        return np.full(walls.shape, math.inf)
    outside = np.sqrt(squared_distances(walls, reach).astype(np.float64))
    inside = np.sqrt(squared_distances(~walls, reach).astype(np.float64))
    cells: NDArray[np.float64] = np.where(walls, 0.5 - inside, outside - 0.5)
    return cells * resolution


def score_poses(
    field: LikelihoodField,
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
    value: Callable[[NDArray[np.float32]], NDArray[np.float32]] | None = None,
) -> NDArray[np.float64]:
    """Return the mean log likelihood (n) per beam of poses (n, 3), for beams with ends (m, 2) in the robot's frame.

    With `value`, the mean of that function of the ends' distances to walls instead.
    """
    grid = field.grid
    scale = 1.0 / grid.resolution
    yaws = (poses[:, 2] - grid.origin.yaw).astype(np.float32)
    # In float32 and cells throughout: this is where the time goes, and 1e-7 of a map is far below a cell.
    base = grid.fractions_of_points(poses[:, :2]).astype(np.float32) + np.float32(1.0)  # 1: the border
    c, s = np.cos(yaws)[:, None], np.sin(yaws)[:, None]
    along, across = (points * scale).astype(np.float32).T
    columns = (base[:, 1:] + c * along - s * across).astype(np.int32)
    rows = (base[:, :1] + s * along + c * across).astype(np.int32)
    height, width = field.distances.shape
    np.clip(columns, 0, width - 1, out=columns)
    np.clip(rows, 0, height - 1, out=rows)
    field.cover(rows, columns)
    entries = field.log_hits if value is None else field.distances  # after `cover`, which may replace them
    rows *= width
    rows += columns
    found = entries.ravel().take(rows)
    scores: NDArray[np.float64] = (found if value is None else value(found)).mean(axis=1, dtype=np.float64)
    return scores


def draw_free_poses(field: LikelihoodField, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw poses (count, 3) on free cells, with any heading. The map must have a free cell."""
    cells = field.free_cells(rng.integers(field.free_count, size=count)) + rng.random((count, 2)) - 0.5
    yaws = rng.uniform(-math.pi, math.pi, count)
    return np.column_stack((field.grid.points_of_cells(cells), yaws))
