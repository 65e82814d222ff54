"""The obstacles in the global costmap of the navigation, which sends it once and then the cells that change."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import rospy
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.grid_message import GridMessage, grid_of_message
from ur_nodes.rosio.grid_update import GridUpdate, apply_update

_LETHAL = 100  # of a published costmap
_LOGGED_EVERY = 10.0  # s


class Obstacles:
    """Subscribes to a costmap and its changes. Any thread may ask."""

    def __init__(self, costmap: str, updates: str) -> None:
        self._lock = threading.Lock()
        self._costs: Grid | None = None  # its values are our own
        self._found: NDArray[np.floating] | None = None
        rospy.Subscriber(updates, GridUpdate, self._take_update)
        rospy.Subscriber(costmap, GridMessage, self._take_costmap, queue_size=1)

    def points(self) -> NDArray[np.floating] | None:
        """The middles (n, 2) of the cells with an obstacle, in m; None while there is no costmap."""
        with self._lock:
            if self._found is None and self._costs is not None:
                self._found = self._costs.points_of_cells(np.argwhere(self._costs.values == _LETHAL))
            return self._found

    def _take_costmap(self, message: OccupancyGrid) -> None:
        try:
            costs = grid_of_message(message)
        except UserError as problem:
            rospy.logerr_throttle(_LOGGED_EVERY, str(problem))
            return
        with self._lock:
            self._costs, self._found = replace(costs, values=costs.values.copy()), None

    def _take_update(self, message: GridUpdate) -> None:
        with self._lock:
            if self._costs is None:
                return
            try:
                apply_update(self._costs.values, message)
            except UserError as problem:  # as after a change of the map's size, before the new costmap arrives
                rospy.logwarn_throttle(_LOGGED_EVERY, str(problem))
                return
            self._found = None
