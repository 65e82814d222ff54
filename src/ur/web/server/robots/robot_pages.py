"""The list of robots for pages, and links to the pages of other robots."""

import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Annotated

from aiohttp import web
from msgspec import Meta

from ur.source.foreign.json_values import ForeignValue
from ur.web.access.rate import Buckets
from ur.web.server.links import link_to
from ur.web.server.logins.gate import SESSION, read_body
from ur.web.server.robots.peer import PeerError
from ur.web.server.robots.robots import Robots

_OPEN_RATE, _OPEN_BURST = 0.2, 20.0  # of a session


class _Robot(ForeignValue, frozen=True, forbid_unknown_fields=False):
    # A host name has at most 63 characters.
    name: Annotated[str, Meta(min_length=1, max_length=63, description="the name of a robot")]


class RobotPages:
    """The routes. `log` is called with a line about each action."""

    def __init__(self, robots: Robots, log: Callable[[str], None]) -> None:
        self._robots, self._log = robots, log
        self._opened = Buckets(_OPEN_RATE, _OPEN_BURST)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [web.get("/api/robots", self._list), web.post("/api/robots", self._open)]

    async def close(self) -> None:
        """End the servers of other robots."""
        await self._robots.close()

    async def _list(self, _request: web.Request) -> web.Response:
        try:
            rows = await self._robots.list()
        except PeerError as problem:
            raise web.HTTPServiceUnavailable(text=f"{problem}\n") from None
        return web.json_response([{**asdict(each), "shown": each.name == self._robots.own} for each in rows])

    async def _open(self, request: web.Request) -> web.Response:
        """Create a link to the page of a listed robot, for one login with the role of the session."""
        name = (await read_body(request, _Robot)).name
        if name == self._robots.own:
            raise web.HTTPConflict(text="this page shows this robot\n")
        session, grant = request[SESSION]
        if not self._opened.allows(session, time.monotonic()):
            raise web.HTTPTooManyRequests(text="too many robots were opened, try again in a minute\n")
        self._log(f"{request.remote} ({grant.name}): opens the page of {name}")
        try:
            place = await self._robots.invite(name, grant.role)
        except PeerError as problem:
            raise web.HTTPConflict(text=f"{problem}\n") from None
        host = request.headers["Host"]  # the browser finds this computer by it
        return web.json_response({"link": link_to(f"{_strip_port(host)}:{place.port}", place.token)})


def _strip_port(host: str) -> str:
    name, colon, port = host.rpartition(":")
    return name if colon and port.isdigit() else host
