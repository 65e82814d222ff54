"""Stored maps over the web: the list for every login; renaming and deletion with the right to drive."""

from collections.abc import Awaitable, Callable
from typing import TypeVar

from aiohttp import web

from ur.web.access.roles import Role
from ur.web.runs.commands import CommandQueue
from ur.web.runs.programs import ProgramsError
from ur.web.runs.stored_maps import StoredMaps
from ur.web.server.logins.gate import SESSION, demand_drive, read_body


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
