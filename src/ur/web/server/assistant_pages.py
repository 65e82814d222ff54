"""Assistants on the page: give them grants to drive, and take these back."""

from collections.abc import Callable, Mapping
from typing import Annotated

from aiohttp import web
from msgspec import Meta, to_builtins

from ur.mcp.assistant import ActionLog
from ur.mcp.grants import Area, GrantFiles, Speed, grant_files, make_area, make_grant
from ur.source.foreign.json_values import ForeignValue
from ur.web.access.roles import clean_name
from ur.web.server.logins.gate import SESSION, demand_drive, read_body

_Id = Annotated[str, Meta(pattern=r"^[0-9a-f]{8}\Z", description="the id of an assistant")]
_Areas = Annotated[tuple[Area, ...], Meta(max_length=10)]


class _GrantGiven(ForeignValue, frozen=True):
    id: _Id
    minutes: Annotated[float, Meta(ge=0.1, le=1440.0)]
    speed: Speed
    within: _Areas = ()
    avoid: _Areas = ()
    programs: bool = False


class _GrantEnded(ForeignValue, frozen=True):
    id: _Id


class AssistantPages:
    """The routes. `log` is called with a line about each action of a client."""

    def __init__(
        self, environment: Mapping[str, str], log: Callable[[str], None], files: GrantFiles | None = None
    ) -> None:
        self._log = log
        self._files = files or grant_files(environment)
        self._actions = ActionLog(self._files.log)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [web.post("/api/assistants/grant", self._grant), web.post("/api/assistants/end", self._end)]

    def describe(self) -> list[dict[str, object]]:
        """Return the assistants of this computer, what they ask for, and their grants, for all pages."""
        found: list[dict[str, object]] = []
        for id, server in self._files.list_servers().items():
            grant = self._files.find(id)
            value = None if grant is None else {**to_builtins(grant.terms()), "programs": grant.programs}
            found.append({"id": id, "name": server.client, "asks": to_builtins(server.asks), "grant": value})
        return found

    async def _grant(self, request: web.Request) -> web.Response:
        demand_drive(request)
        asked = await read_body(request, _GrantGiven)
        server = self._files.list_servers().get(asked.id)
        if server is None:
            raise web.HTTPNotFound(text="this assistant has ended\n")
        within, avoid = (tuple(map(_arrange, each)) for each in (asked.within, asked.avoid))
        grant = make_grant(asked.minutes, asked.speed, within, avoid, programs=asked.programs)
        self._files.give(asked.id, grant)
        self._note(request, f"lets {server.client} drive: {grant.text}", server.client)
        return web.json_response({"text": grant.text})

    async def _end(self, request: web.Request) -> web.Response:
        """Take a grant back, or refuse what an assistant asks for. Every login may: it stops a robot."""
        asked = await read_body(request, _GrantEnded)
        server = self._files.list_servers().get(asked.id)
        self._files.revoke(asked.id)
        self._files.answer(asked.id)
        name = server.client if server is not None else asked.id
        self._note(request, f"does not let {name} drive any more", name)
        return web.json_response({"ok": True})

    def _note(self, request: web.Request, what: str, client: str = "") -> None:
        name = request[SESSION][1].name
        self._log(f"{request.remote} ({name}): {what}")
        if client:
            self._actions.add(client, "grant", {}, f"{name} ({request.remote}), on the page, {what}")


def _arrange(area: Area) -> Area:
    return make_area(area.left, area.bottom, area.right, area.top, clean_name(area.name))
