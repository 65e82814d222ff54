"""Assistants on the page: connect them, give them grants to drive, and take these back; and their own requests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated

from aiohttp import web
from msgspec import Meta, to_builtins

from ur.mcp.action_log import ActionLog
from ur.mcp.grants import GrantFiles, grant_files, make_grant
from ur.mcp.terms import Area, Speed, make_area
from ur.source.foreign.json_values import ForeignValue
from ur.web.access.roles import clean_name
from ur.web.server.assistants.assistant_servers import AssistantServers
from ur.web.server.logins.gate import ASSISTANT_PATH, SESSION, LoginGate, demand_drive, read_body

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


class _NameGiven(ForeignValue, frozen=True):
    name: Annotated[str, Meta(max_length=40)] = ""


class AssistantPages:
    """The routes. `log` is called with a line about each action of a client."""

    def __init__(
        self,
        gate: LoginGate,
        environment: Mapping[str, str],
        log: Callable[[str], None],
        files: GrantFiles | None = None,
        servers: AssistantServers | None = None,
    ) -> None:
        self._gate, self._log = gate, log
        self._files = files or grant_files(environment)
        self._actions = ActionLog(self._files.log)
        self._servers = servers or AssistantServers(environment, self._files, log)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [
            web.get(ASSISTANT_PATH, self._serve, allow_head=False),
            web.post(ASSISTANT_PATH, self._serve),
            web.delete(ASSISTANT_PATH, self._serve),
            web.post("/api/assistants/connect", self._connect),
            web.post("/api/assistants/grant", self._grant),
            web.post("/api/assistants/end", self._end),
        ]

    def describe(self) -> list[dict[str, object]]:
        """Return the assistants of this computer, what they ask for, and their grants, for all pages."""
        found: list[dict[str, object]] = []
        for id, server in self._files.list_servers().items():
            grant = self._files.find(id)
            value = None if grant is None else {**to_builtins(grant.terms()), "programs": grant.programs}
            found.append({"id": id, "name": server.client, "asks": to_builtins(server.asks), "grant": value})
        return found

    def poll(self) -> None:
        """End what a login has served that has ended."""
        self._servers.poll(self._gate.sessions.list())

    async def close(self) -> None:
        """End the servers of all assistants that are connected here."""
        await self._servers.close()

    async def _serve(self, request: web.Request) -> web.StreamResponse:
        session, grant = request[SESSION]
        return await self._servers.serve(request, session, grant.name)

    async def _connect(self, request: web.Request) -> web.Response:
        """Make an address and a secret for an assistant. The secret is shown once."""
        demand_drive(request)
        name = clean_name((await read_body(request, _NameGiven)).name) or "assistant"
        await self._servers.prepare()
        _, secret = self._gate.sessions.add_assistant(name, request.remote or "")
        self._note(request, f"connects an assistant, {name}")
        return web.json_response({"url": f"http://{request.host}{ASSISTANT_PATH}", "secret": secret})

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
        self._files.take_back(asked.id)
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
