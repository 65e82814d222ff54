"""The obstacles in the global costmap of the navigation, which sends it once and then the cells that change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, MapUpdate

_LETHAL = 100  # of a published costmap
_LOGGED_EVERY = 10.0  # s


class Obstacles:
    """Listens to a costmap and its changes."""

    def __init__(self, node: Node, costmap: str, updates: str) -> None:
        self._log = node.log
        self._costs: Grid | None = None  # its values are our own
        self._found: NDArray[np.floating] | None = None
        node.subscribe(updates, MapUpdate, self._take_update, Quality.EVERY)
        node.subscribe(costmap, Map, self._take_costmap)

    def points(self) -> NDArray[np.floating] | None:
        """The middles (n, 2) of the cells with an obstacle, in m; None while there is no costmap."""
        if self._found is None and self._costs is not None:
            self._found = self._costs.points_of_cells(np.argwhere(self._costs.values == _LETHAL))
        return self._found

    def _take_costmap(self, given: Map) -> None:
        self._costs, self._found = replace(given.grid, values=given.grid.values.copy()), None

    def _take_update(self, update: MapUpdate) -> None:
        if self._costs is None:
            return
        values = self._costs.values
        rows, columns = update.values.shape
        fits = update.row + rows <= values.shape[0] and update.column + columns <= values.shape[1]
        if not fits or update.row < 0 or update.column < 0:  # as after a change of the map's size
            height, width = values.shape
            expected = f"expected cells inside the grid of {width} x {height}"
            self._log.warn(f"an update reaches beyond the costmap, {expected}", every=_LOGGED_EVERY)
            return
        values[update.row : update.row + rows, update.column : update.column + columns] = update.values
        self._found = None
