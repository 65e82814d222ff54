"""Stored maps over the web: the list for every login; renaming and deletion with the right to drive."""

import asyncio
import math
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar

from aiohttp import web

from ur.maps.names import check_map_name
from ur.source.diagnostic import UserError
from ur.web.access.roles import Role
from ur.web.runs.commands import CommandQueue
from ur.web.runs.programs import ProgramsError, explain_failure, parse_output
from ur.web.server.logins.gate import SESSION, demand_drive, read_body

_READING = 60.0  # time limit (s) of a command
_CHANGING = 20.0
_MOST_MAPS = 200
_SHOWN = ("name", "changed", "width", "height", "places", "latest", "problem", "picture")


class StoredMaps:
    """Lists and changes stored maps. Each method raises ProgramsError."""

    def __init__(self, commands: CommandQueue) -> None:
        self._commands = commands
        self._reading = asyncio.Lock()
        self._read_at = -math.inf
        self._listed: list[dict[str, object]] = []

    async def list_all(self) -> list[dict[str, object]]:
        """List the maps with a small picture each, as `ur maps --json --pictures` does, without paths."""
        asked = time.monotonic()
        async with self._reading:
            if self._read_at < asked:  # waiting callers share the answer of the first one
                began = time.monotonic()
                done = await self._commands.run("maps", "--json", "--pictures", limit=_READING)
                found = parse_output(done, list[dict[str, object]], "the maps cannot be listed")
                self._listed = [{key: each.get(key) for key in _SHOWN} for each in found[:_MOST_MAPS]]
                self._read_at = began
            return self._listed

    async def rename(self, before: object, after: object) -> None:
        """Rename a map; its places stay with it."""
        words = read_name(before), read_name(after)
        await self._change(f"map {words[0]!r} was not renamed", "rename", *words)

    async def delete(self, name: object) -> None:
        """Delete a map permanently."""
        word = read_name(name)
        await self._change(f"map {word!r} was not deleted", "delete", word, "--yes")

    async def _change(self, otherwise: str, *words: str) -> None:
        done = await self._commands.run("maps", *words, limit=_CHANGING)
        if done.code != 0 or done.late:
            raise ProgramsError(explain_failure(done, otherwise))


def read_name(value: object) -> str:
    """Return the name of a map in a request, which cannot be a path or an option. Raises ProgramsError."""
    if not isinstance(value, str):
        raise ProgramsError("name: expected the name of a map")
    try:
        return check_map_name(value)
    except UserError as problem:
        raise ProgramsError(str(problem)) from None


class MapPages:
    """The routes and their dependencies. `log` is called with a line about each action."""

    def __init__(self, commands: CommandQueue, log: Callable[[str], None]) -> None:
        self._log = log
        self._maps = StoredMaps(commands)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [
            web.get("/api/maps", self._list),
            web.post("/api/maps/rename", self._rename),
            web.post("/api/maps/delete", self._delete),
        ]

    async def _list(self, request: web.Request) -> web.Response:
        """List the maps; without pictures for a login that may only view."""
        rows = await answer_command(self._maps.list_all())
        if request[SESSION][1].role is not Role.DRIVE:
            rows = [{**row, "picture": []} for row in rows]
        return web.json_response(rows)

    async def _rename(self, request: web.Request) -> web.Response:
        demand_drive(request)
        value = await read_body(request, dict)
        await answer_command(self._maps.rename(value.get("name"), value.get("new_name")))
        self._note(request, f"has renamed map {value['name']} to {value['new_name']}")
        return web.json_response({"ok": True})

    async def _delete(self, request: web.Request) -> web.Response:
        demand_drive(request)
        value = await read_body(request, dict)
        await answer_command(self._maps.delete(value.get("name")))
        self._note(request, f"has deleted map {value['name']}")
        return web.json_response({"ok": True})

    def _note(self, request: web.Request, what: str) -> None:
        self._log(f"{request.remote} ({request[SESSION][1].name}): {what}")


Result = TypeVar("Result")


async def answer_command(work: Awaitable[Result]) -> Result:
    """Return the result of a command of `ur`. Raises HTTPConflict with its error."""
    try:
        return await work
    except ProgramsError as problem:
        raise web.HTTPConflict(text=f"{problem}\n") from None
