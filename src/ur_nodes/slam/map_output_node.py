"""Draws the map of a mapper every few seconds, publishes it, and answers who asks for it."""

from __future__ import annotations

import threading
from collections.abc import Callable

import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapRequest, GetMapResponse

from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.grid_message import grid_message
from ur_nodes.slam.gmapping_settings import GmappingSettings
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.occupancy import OccupancyMap


class MapOutput:
    """The topics `map` and `map_metadata`, latched, and the service `dynamic_map`.

    `state` gives the map as of now. The map is drawn in a thread of its own, so no scan waits for it.
    """

    def __init__(self, settings: GmappingSettings, state: Callable[[], MapState]) -> None:
        self._settings = settings
        self._state = state
        self._drawn = OccupancyMap(settings.delta, settings.occ_thresh, settings.max_usable or float("inf"))
        if settings.edges:
            self._drawn.include(settings.edges[:2], settings.edges[2:])
        self._lock = threading.Lock()  # guards _drawn
        self._map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        self._metadata = rospy.Publisher("map_metadata", MapMetaData, queue_size=1, latch=True)
        rospy.Service("dynamic_map", GetMap, self._answer)

    def publish(self) -> None:
        """Draw what has changed, and publish the map; nothing happens before the first keyframe."""
        with self._lock:
            message = self._draw()
        if message:
            self._map.publish(message)
            self._metadata.publish(message.info)

    def draw(self, state: MapState) -> Grid:
        """Return the picture of a map with at least one keyframe."""
        with self._lock:
            self._drawn.update(state.poses, state.scans, state.drives)
            return self._drawn.grid()

    def _draw(self) -> OccupancyGrid | None:
        state = self._state()
        if not state.poses:
            return None
        self._drawn.update(state.poses, state.scans, state.drives)
        return grid_message(self._drawn.grid(), self._settings.map_frame, rospy.Time.now())

    def _answer(self, _request: GetMapRequest) -> GetMapResponse:
        with self._lock:
            message = self._draw()
        if message is None:
            raise rospy.ServiceException("there is no map yet; is the lidar driver running?")
        return GetMapResponse(message)
