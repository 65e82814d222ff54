"""Places of a route that a request gives by name: the waypoints of the map on the computer of this node."""

from __future__ import annotations

import os
from dataclasses import replace

import rospy
from nav_msgs.msg import OccupancyGrid

from ur_nodes.missions.patrol_text import BadPatrolError, Route, Stop
from ur_nodes.rosio.grid_message import grid_of_message
from ur_nodes.teleop.navigator.waypoints import WaypointStore, choose_file, read_settings

_MAP_WAIT = 2.0  # s


def find_places(route: Route, keeper: str) -> Route:
    """The route with all poses; the parameters of the node `keeper` lead to the file of waypoints.

    Raises UserError: there is no such waypoint; BadPatrolError: there is no map.
    """
    if all(stop.x is not None for stop in route.stops):
        return route
    settings, grid = read_settings(rospy.get_param(keeper, None)), None
    if not (settings.file or settings.map_name):
        try:
            grid = grid_of_message(rospy.wait_for_message("map", OccupancyGrid, timeout=_MAP_WAIT))
        except rospy.ROSException:
            raise BadPatrolError("a map, whose waypoints have names") from None
    path = choose_file(settings, grid, os.environ)
    if path is None:
        raise BadPatrolError("a map that has been saved under a name, whose waypoints have names")
    store = WaypointStore(path)
    return replace(route, stops=tuple(_find(store, stop) for stop in route.stops))


def _find(store: WaypointStore, stop: Stop) -> Stop:
    return stop if stop.x is not None else Stop(stop.name, *store.find(stop.name))
