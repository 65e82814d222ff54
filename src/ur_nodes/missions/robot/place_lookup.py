"""Places of a route that a request gives by name: the waypoints of the map on the computer of this node."""

import os
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from ur.source.diagnostic import UserError
from ur_nodes.client.patrol_text import PatrolRoute, PatrolStop
from ur_nodes.client.waypoints import PlaceSettings, WaypointStore, choose_file, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.node import Node, Subscription, Timer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map

_MAP_WAIT = 2.0  # s
_MOST_WAITING = 10  # routes
TOO_MANY = "expected fewer requests at once"
NO_ANSWER = "expected a parameter server that answers"
NO_MAP = "expected a map, whose waypoints have names"
NO_NAME = "expected a map that has been saved under a name, whose waypoints have names"

Take = Callable[[PatrolRoute | str], None]
"""Takes a route with all poses, or why there is none."""


class PlaceLookup:
    """Looks up the places of routes, one route after the other."""

    def __init__(self, node: Node, keeper: str) -> None:
        """The parameters of the node `keeper` lead to the file of waypoints."""
        self._node, self._keeper = node, keeper
        self._waiting: deque[tuple[PatrolRoute, Take]] = deque()  # the first is being looked up
        self._map: Subscription | None = None
        self._late: Timer | None = None

    def find(self, route: PatrolRoute, callback: Take) -> None:
        """Look up the places of a route, after those of earlier routes, and pass the result to `callback`.

        Of more than _MOST_WAITING waiting requests, the oldest is dropped.
        """
        self._waiting.append((route, callback))
        if len(self._waiting) == 1:
            self._begin()
        elif len(self._waiting) > 1 + _MOST_WAITING:
            _, give_up = self._waiting[1]
            del self._waiting[1]
            give_up(TOO_MANY)

    def _begin(self) -> None:
        route, _ = self._waiting[0]
        if all(stop.x is not None for stop in route.stops):
            self._finish(route)
            return
        keeper = self._node.parameters.of(self._keeper)

        def read() -> PlaceSettings | str:
            names = ("map_name", "waypoints_file", "save_service")
            try:
                return read_settings({name: keeper.any(name) for name in names})
            except Exception:  # a parameter server may answer anything, or nothing
                return NO_ANSWER

        self._node.work(read, self._on_settings, "places")

    def _on_settings(self, settings: PlaceSettings | str) -> None:
        if isinstance(settings, str):
            self._finish(settings)
            return
        if settings.file or settings.map_name:
            self._look_up(settings, None)
            return
        take = partial(self._on_map, settings)
        self._map = self._node.subscribe("map", Map, take, Quality.LATCHED, unreadable=take)
        self._late = self._node.after(_MAP_WAIT, partial(take, NO_MAP), steady=True)

    def _on_map(self, settings: PlaceSettings, found: Map | str) -> None:
        """Take the map, or the reason why there is none."""
        if self._map is None or self._late is None:
            return
        self._map.close()
        self._late.cancel()
        self._map = self._late = None
        if isinstance(found, str):
            self._finish(found)
        else:
            self._look_up(settings, found.grid)

    def _look_up(self, settings: PlaceSettings, grid: Grid | None) -> None:
        route, _ = self._waiting[0]
        self._node.work(lambda: look_up(route, settings, grid), self._finish, "places")

    def _finish(self, found: PatrolRoute | str) -> None:
        _, take = self._waiting.popleft()
        take(found)
        if self._waiting:
            self._begin()


def look_up(route: PatrolRoute, settings: PlaceSettings, grid: Grid | None) -> PatrolRoute | str:
    """Return the route with all poses, or the reason why not; `grid` is the map if the settings name none."""
    path = choose_file(settings, grid, os.environ)
    if path is None:
        return NO_NAME
    store = WaypointStore(path)
    try:
        return replace(route, stops=tuple(_find(store, stop) for stop in route.stops))
    except UserError as problem:
        return problem.diagnostics[0].message


def _find(store: WaypointStore, stop: PatrolStop) -> PatrolStop:
    return stop if stop.x is not None else PatrolStop(stop.name, *store.find(stop.name))
