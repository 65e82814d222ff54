"""The global costmap: the map, its keep-out zones, what the scan has seen besides, and slopes round all of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import (
    LETHAL,
    UNKNOWN,
    Box,
    Costmap,
    Inflation,
    costs_of_grid,
    inflate,
    inflate_window,
    joined,
)
from ur_nodes.costmap.layers import Beams, UsedRanges, trace_beams
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.sparse_array import sparse_twins, sparse_zeros

_STRIP = 1 << 17  # cells that are looked at together
_FORBIDDEN = 100  # in a mask
# What the scan sees this near (m) to an obstacle of the map is that obstacle, seen from a pose that is not quite right,
# and is not marked.
_KNOWN = 0.12


class MapCostmap:
    """Costs over a whole map, kept up to date where something changes: a byte a cell, and another where it does."""

    def __init__(
        self, grid: Grid, reach: UsedRanges, inflation: Inflation, *, lethal: int, track_unknown: bool
    ) -> None:
        self._reach = reach
        self.inflation = inflation
        costs = costs_of_grid(grid, lethal=lethal, track_unknown=track_unknown)
        plain, self._costs = sparse_twins(inflate(costs, grid.resolution, inflation))
        self._plain = Costmap(plain, grid.resolution, grid.origin)
        self.static = self._plain  # the map with its keep-out zones, without what was seen
        self.zones: Costmap | None = None  # as obstacles (254)
        self._zone_box: Box | None = None  # holds all of the zones
        self._occupied: NDArray[np.bool_] = sparse_zeros(costs.shape, bool)
        self._marked: Box | None = None  # holds all of _occupied
        self._touched = np.empty((0, 2), np.intp)  # cells
        far = math.floor(_KNOWN / grid.resolution)
        offsets = np.stack(np.meshgrid(*[np.arange(-far, far + 1)] * 2), axis=-1).reshape(-1, 2)
        self._near = offsets[np.hypot(*offsets.T) <= _KNOWN / grid.resolution]
        self._known: NDArray[np.int8] = sparse_zeros(costs.shape, np.int8)  # of `_is_known`: 1 and -1, 0 not looked at
        self._changed: Box | None = None
        self.changes = 0

    def grid(self) -> Grid:
        """Return a map with the same obstacles and unknown cells."""
        costs = self._plain.costs
        values = np.where(costs == LETHAL, 100, np.where(costs == UNKNOWN, -1, 0)).astype(np.int8)
        return Grid(values, self._plain.resolution, self._plain.origin)

    def mark_like(self, other: MapCostmap) -> None:
        """Mark what the scan has seen on another costmap of the same map."""
        self._occupied, self._marked, self._touched = other._occupied, other._marked, other._touched
        for box in (self._marked, _box_round(self._touched)):
            if box is not None:
                self._refresh(box)

    @property
    def walls(self) -> Costmap:
        """The costs of the map alone."""
        return self._plain

    @property
    def costmap(self) -> Costmap:
        """The present costs. Its array changes with the next update."""
        return Costmap(self._costs, self._plain.resolution, self._plain.origin)

    def pop_changes(self) -> Box | None:
        """Return the box of what has changed since the last call, None for nothing."""
        box, self._changed = self._changed, None
        return box

    def explains(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Mark the points (n, 2) in the map that are an obstacle of it or near one; also those outside of it."""
        cells = self._plain.cells_of_points(points)
        inside = self._plain.contains(cells)
        explained = ~inside
        explained[inside] = self._is_known(cells[inside])
        return explained

    def update(self, sensor: Pose2, beams: Beams) -> bool:
        """Clear and mark with a scan taken from `sensor` (in the map). Returns whether anything changed."""
        box = trace_beams(self._occupied, self._plain, sensor, beams, self._reach, ignore=self._is_known)
        if box is not None:
            self._marked = joined(self._marked, box)
            self._refresh(box)
        return box is not None

    def touch(self, points: NDArray[np.float64]) -> None:
        """Mark points (n, 2) in the map, in place of those of before, as obstacles that no ray clears."""
        if not len(points) and not len(self._touched):
            return
        cells = self._plain.cells_of_points(points)
        before, self._touched = self._touched, np.unique(cells[self._plain.contains(cells)], axis=0)
        if not np.array_equal(before, self._touched):
            box = _box_round(np.concatenate((before, self._touched)))
            assert box is not None
            self._refresh(box)

    def untouched(self) -> Costmap:
        """Return the costs without what was touched."""
        costs, box = self._costs.copy(), _box_round(self._touched)
        if box is not None:
            inflate_window(costs, self._seen, self._plain.resolution, self.inflation, box)
        return Costmap(costs, self._plain.resolution, self._plain.origin)

    def forbid(self, mask: Grid | None) -> None:
        """Keep out of the cells for which a mask has 100, in place of those of before; None: of none.

        They are obstacles for planning. What the scan sees in them is marked and cleared as elsewhere.
        """
        before, self.zones, self._zone_box = self._zone_box, None, None
        self.static = self._plain
        box = None if mask is None else self._box_of(mask)
        if mask is not None and box is not None:
            zones = sparse_zeros(self._plain.shape, np.uint8)
            rows, columns = box
            step = max(1, _STRIP // (columns.stop - columns.start))
            for low in range(rows.start, rows.stop, step):
                part = slice(low, min(low + step, rows.stop)), columns
                cells = np.moveaxis(np.mgrid[part], 0, -1)
                zones[part][mask.values_at(self._plain.points_of_cells(cells), outside=0) == _FORBIDDEN] = LETHAL
            self.zones, self._zone_box = Costmap(zones, self._plain.resolution, self._plain.origin), box
            static = self._plain.costs.copy()
            inflate_window(static, self._fixed, self._plain.resolution, self.inflation, box)
            self.static = Costmap(static, self._plain.resolution, self._plain.origin)
        for changed in (before, box):
            if changed is not None:
                self._refresh(changed)

    def clear(self, keep: Pose2 | None = None, distance: float = 0.0) -> None:
        """Forget what the scan has seen, everywhere or outside a square of half side `distance` round a place."""
        box = self._marked
        if box is None:
            self.changes += 1
            return
        before = self._occupied[box].copy()
        self._occupied[box] = False
        if keep is not None:
            row, column = self._plain.fractions_of_points(np.array((keep.x, keep.y)))
            reach = distance / self._plain.resolution
            top, left = box[0].start, box[1].start
            rows = slice(max(0, math.floor(row - reach) - top), max(0, math.ceil(row + reach) - top))
            columns = slice(max(0, math.floor(column - reach) - left), max(0, math.ceil(column + reach) - left))
            self._occupied[box][rows, columns] = before[rows, columns]
        else:
            self._marked = None
        self._refresh(box)

    def _refresh(self, box: Box) -> None:
        changed = inflate_window(self._costs, self._merged, self._plain.resolution, self.inflation, box)
        self._changed = joined(self._changed, changed)
        self.changes += 1

    def _merged(self, box: Box) -> NDArray[np.uint8]:
        """The costs in a box before inflation."""
        result, cells = self._seen(box), self._touched - (box[0].start, box[1].start)
        inside = ((cells >= 0) & (cells < result.shape)).all(axis=1)
        result[tuple(cells[inside].T)] = LETHAL
        return result

    def _seen(self, box: Box) -> NDArray[np.uint8]:
        """Those of map, zones and what was seen."""
        result = self._fixed(box)
        result[self._occupied[box]] = LETHAL
        return result

    def _fixed(self, box: Box) -> NDArray[np.uint8]:
        """Those of map and zones. Slopes of the map count as free: they come back with its walls."""
        plain = self._plain.costs[box]
        result: NDArray[np.uint8] = np.where((plain == LETHAL) | (plain == UNKNOWN), plain, np.uint8(0))
        if self.zones is not None:
            result[self.zones.costs[box] == LETHAL] = LETHAL
        return result

    def _box_of(self, mask: Grid) -> Box | None:
        """The rows and columns of the map that a mask may cover; None: none."""
        corners = np.array([(row, column) for row in (0, mask.height) for column in (0, mask.width)]) - 0.5
        cells = self._plain.fractions_of_points(mask.points_of_cells(corners))
        low = np.clip(np.floor(cells.min(axis=0)), 0, self._plain.shape).astype(int).tolist()
        high = np.clip(np.ceil(cells.max(axis=0)), 0, self._plain.shape).astype(int).tolist()
        empty = low[0] >= high[0] or low[1] >= high[1]
        return None if empty else (slice(low[0], high[0]), slice(low[1], high[1]))

    def _is_known(self, cells: NDArray[np.intp]) -> NDArray[np.bool_]:
        """True (n) for cells (n, 2) that are an obstacle of the map or near one."""
        rows, columns = cells.T
        known: NDArray[np.int8] = self._known[rows, columns]
        new = np.flatnonzero(known == 0)
        if len(new):
            height, width = self._plain.shape
            near = cells[new, None] + self._near
            # Beyond the border the outermost cells stand for what is there: no nearer to the cell than they are.
            near_rows, near_columns = np.clip(near[..., 0], 0, height - 1), np.clip(near[..., 1], 0, width - 1)
            found = (self._plain.costs[near_rows, near_columns] == LETHAL).any(axis=1)
            known[new] = self._known[rows[new], columns[new]] = np.where(found, 1, -1)
        return known > 0


def _box_round(cells: NDArray[np.intp]) -> Box | None:
    """Return the box of cells (n, 2); None without any."""
    if not len(cells):
        return None
    (top, left), (bottom, right) = cells.min(axis=0).tolist(), cells.max(axis=0).tolist()
    return slice(top, bottom + 1), slice(left, right + 1)
