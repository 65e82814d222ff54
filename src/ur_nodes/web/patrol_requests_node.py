"""Requests of pages for a patrol, passed on to the robot's node with the poses of places."""

from __future__ import annotations

from collections.abc import Callable

from ur.web.wire.requests import AskPatrol
from ur_nodes.client.patrol_text import PatrolRequest, Route, Stop
from ur_nodes.teleop.navigator.patrol_link_node import PatrolLink
from ur_nodes.web.places import Places


def ask_patrol(
    link: PatrolLink, places: Places, request: AskPatrol, id: str, client: str, name: str, done: Callable[[str], None]
) -> None:
    """Pass a request on; the node checks its age, and who drives. `done` is called with why it is refused, or ''.

    `client` and `name` are those of the page; `id` is the request's own.
    """
    stops = tuple(_find(places, each) for each in request.stops)
    if None in stops:
        done("no place")
        return
    route = Route(tuple(each for each in stops if each), request.loop, request.wait)
    if not link.request(PatrolRequest(request.action, route, id, client, name, request.answers), done):
        done("no patrol")


def _find(places: Places, stop: str | tuple[float, float]) -> Stop | None:
    if not isinstance(stop, str):
        return Stop("", *stop)
    place = places.find(stop)
    return None if place is None else Stop(stop, *place)
