"""Stored maps over the web: the list, for every login."""

import asyncio
import math
import time
from collections.abc import Awaitable
from typing import TypeVar

from aiohttp import web

from ur.web.access.roles import Role
from ur.web.runs.programs import ProgramsError, parse_output
from ur.web.runs.watcher import CommandQueue
from ur.web.server.logins.gate import SESSION

_READING = 60.0  # time limit (s) of the command
_MOST_MAPS = 200
_SHOWN = ("name", "changed", "width", "height", "places", "latest", "problem", "picture")


class StoredMaps:
    """Lists stored maps."""

    def __init__(self, commands: CommandQueue) -> None:
        self._commands = commands
        self._reading = asyncio.Lock()
        self._read_at = -math.inf
        self._listed: list[dict[str, object]] = []

    async def list_all(self) -> list[dict[str, object]]:
        """List the maps with a small picture each, as `ur maps --json --pictures` does, without paths.

        Raises ProgramsError.
        """
        asked = time.monotonic()
        async with self._reading:
            if self._read_at < asked:  # waiting callers share the answer of the first one
                began = time.monotonic()
                done = await self._commands.run("maps", "--json", "--pictures", limit=_READING)
                found = parse_output(done, list[dict[str, object]], "the maps cannot be listed")
                self._listed = [{key: each.get(key) for key in _SHOWN} for each in found[:_MOST_MAPS]]
                self._read_at = began
            return self._listed


class MapPages:
    """The route."""

    def __init__(self, commands: CommandQueue) -> None:
        self._maps = StoredMaps(commands)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [web.get("/api/maps", self._list)]

    async def _list(self, request: web.Request) -> web.Response:
        """List the maps; without pictures for a login that may only view."""
        rows = await answer_command(self._maps.list_all())
        if request[SESSION][1].role is not Role.DRIVE:
            rows = [{**row, "picture": []} for row in rows]
        return web.json_response(rows)


Result = TypeVar("Result")


async def answer_command(work: Awaitable[Result]) -> Result:
    """Return the result of a command of `ur`. Raises HTTPConflict with its error."""
    try:
        return await work
    except ProgramsError as problem:
        raise web.HTTPConflict(text=f"{problem}\n") from None
