"""The global costmap: the map, what the scan has seen that the map does not know, and slopes round both."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from ur_nodes.costmap.costmap import LETHAL, Costmap, Inflation, costs_of_grid, inflate, inflate_window
from ur_nodes.costmap.layers import Beams, Ranges, trace_beams
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


class MapCostmap:
    """Costs over a whole map, kept up to date where something changes.

    `known` (m): what the scan sees this near to an obstacle of the map is that obstacle, seen from a pose that is
    not quite right, and is not marked.
    """

    def __init__(
        self, grid: Grid, reach: Ranges, inflation: Inflation, *, lethal: int, track_unknown: bool, known: float = 0.12
    ) -> None:
        self._grid = grid
        self._reach = reach
        self._inflation = inflation
        self._static = costs_of_grid(grid, lethal=lethal, track_unknown=track_unknown)
        self._occupied: NDArray[np.bool_] = np.zeros(self._static.shape, bool)
        self._known = _near(self._static == LETHAL, known / grid.resolution)
        self._plain = Costmap(inflate(self._static, grid.resolution, inflation), grid.resolution, grid.origin)
        self._costs = self._plain.costs.copy()
        self.changes = 0

    @property
    def static(self) -> Costmap:
        """The costs of the map alone."""
        return self._plain

    @property
    def costmap(self) -> Costmap:
        """The present costs. Its array changes with the next update."""
        return Costmap(self._costs, self._grid.resolution, self._grid.origin)

    @property
    def frozen(self) -> Costmap:
        """A copy of the present costs, for use while updates go on."""
        return Costmap(self._costs.copy(), self._grid.resolution, self._grid.origin)

    def update(self, sensor: Pose2, beams: Beams) -> bool:
        """Clear and mark with a scan taken from `sensor` (in the map). Returns whether anything changed."""
        frame = self.costmap
        box = trace_beams(self._occupied, frame, sensor, beams, self._reach, ignore=self._known)
        if box is not None:
            self._refresh(box)
        return box is not None

    def clear(self, keep: Pose2 | None = None, distance: float = 0.0) -> None:
        """Forget what the scan has seen, everywhere or outside a square of half side `distance` round a place."""
        if keep is not None:
            row, column = self.costmap.fractions_of_points(np.array((keep.x, keep.y)))
            reach = distance / self._grid.resolution
            kept = self._occupied.copy()
            rows = slice(max(0, math.floor(row - reach)), max(0, math.ceil(row + reach)))
            columns = slice(max(0, math.floor(column - reach)), max(0, math.ceil(column + reach)))
            kept[rows, columns] = False
            self._occupied &= ~kept
        else:
            self._occupied[:] = False
        self._refresh((slice(0, self._grid.height), slice(0, self._grid.width)))

    def _refresh(self, box: tuple[slice, slice]) -> None:
        merged = np.where(self._occupied, np.uint8(LETHAL), self._static).astype(np.uint8)
        inflate_window(self._costs, merged, self._grid.resolution, self._inflation, box)
        self.changes += 1


def _near(lethal: NDArray[np.bool_], cells: float) -> NDArray[np.bool_]:
    reach = math.floor(cells)
    if reach < 1:
        return lethal
    offsets = np.arange(-reach, reach + 1)
    disc = np.hypot(offsets[:, None], offsets) <= cells
    near: NDArray[np.bool_] = binary_dilation(lethal, structure=disc)
    return near
