"""The obstacles in the global costmap of the navigation, which sends it once and then the cells that change."""

import numpy as np
from numpy.typing import NDArray

from ur_nodes.ports.kept_map import KeptMap
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, MapUpdate

_LETHAL = 100  # of a published costmap
_LOGGED_EVERY = 10.0  # s


class Obstacles:
    """Subscribes to a costmap and its updates."""

    def __init__(self, node: Node, costmap: str, updates: str) -> None:
        self._log = node.log
        self._costs = KeptMap()
        self._found: NDArray[np.floating] | None = None
        node.subscribe(updates, MapUpdate, self._on_update, Quality.EVERY)
        node.subscribe(costmap, Map, self._on_costmap)

    def points(self) -> NDArray[np.floating] | None:
        """Return the centres (n, 2) of cells with an obstacle, in m; None while there is no costmap."""
        if self._found is None and self._costs.map is not None:
            grid = self._costs.map.grid
            self._found = grid.points_of_cells(np.argwhere(grid.values == _LETHAL))
        return self._found

    def _on_costmap(self, given: Map) -> None:
        self._costs.replace(given)
        self._found = None

    def _on_update(self, update: MapUpdate) -> None:
        if problem := self._costs.apply(update):
            self._log.warn(f"costmap: {problem}", every=_LOGGED_EVERY)
        else:
            self._found = None
