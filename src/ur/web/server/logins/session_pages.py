"""Pages about logged-in devices: list, names, logout, and links for other devices."""

import time
from collections.abc import Callable

from aiohttp import web

from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import ForeignValue
from ur.web.access.origin import LOOPBACK
from ur.web.access.rate import Buckets
from ur.web.access.roles import Grant, Role, clean_name
from ur.web.server.links import draw_picture, find_address, link_to
from ur.web.server.logins.gate import SESSION, LoginGate, demand_drive, read_body

_INVITE_RATE, _INVITE_BURST = 0.1, 10.0
_OTHERS = "others"


class _Invitation(ForeignValue, frozen=True):
    role: Role


class SessionPages:
    """The routes. `rename` is called with a session's new name; `log` is called with a line about each action."""

    def __init__(self, gate: LoginGate, rename: Callable[[str, str], None], log: Callable[[str], None]) -> None:
        self._gate, self._rename, self._log = gate, rename, log
        self._invitations = Buckets(_INVITE_RATE, _INVITE_BURST)

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [
            web.get("/api/sessions", self._list),
            web.post("/api/sessions/end", self._end),
            web.post("/api/sessions/name", self._name),
            web.post("/api/invite", self._invite),
        ]

    async def _list(self, request: web.Request) -> web.Response:
        """List the sessions, that of the request first."""
        demand_drive(request)
        own, sessions = request[SESSION][0], self._gate.sessions
        rows = [self._describe(number, grant, own=number == own) for number, grant in sessions.list().items()]
        return web.json_response(sorted(rows, key=lambda row: (not row["own"], -row["last"])))

    def _describe(self, number: str, grant: Grant, *, own: bool) -> dict[str, object]:
        return {
            "id": number,
            "name": grant.name,
            "role": grant.role.value,
            "address": grant.address,
            "first": grant.first,
            "last": time.time() if own else grant.last,
            "until": grant.until,
            "own": own,
            "open": self._gate.sessions.count_open(number) > 0,
        }

    async def _end(self, request: web.Request) -> web.Response:
        """End one session by its id, or all except that of the request."""
        demand_drive(request)
        asked = str((await read_body(request, dict)).get("id"))
        own, sessions = request[SESSION][0], self._gate.sessions
        ids = [each for each in sessions.list() if (each != own if asked == _OTHERS else each == asked)]
        if not ids and asked != _OTHERS:
            raise web.HTTPNotFound(text="this session has ended\n")
        self._log(f"{request.remote} ({request[SESSION][1].name}): ends {len(ids)} session(s)")
        sessions.end(ids)
        return web.json_response({"ended": len(ids)})

    async def _name(self, request: web.Request) -> web.Response:
        """Rename a session by its id: that of the request, or any with the right to drive."""
        value = await read_body(request, dict)
        own = request[SESSION][0]
        asked = str(value.get("id", own))
        if asked != own:
            demand_drive(request)
        name, sessions = clean_name(value.get("name")), self._gate.sessions
        if not name:
            raise web.HTTPBadRequest(text="expected a name of 1 to 40 characters\n")
        if asked not in sessions.list():
            raise web.HTTPNotFound(text="this session has ended\n")
        self._log(f"{request.remote} ({request[SESSION][1].name}): names a session {name}")
        given = sessions.rename(asked, name)
        self._rename(asked, given)
        return web.json_response({"name": given})

    async def _invite(self, request: web.Request) -> web.Response:
        """Make a link for one login of another device, and its QR code."""
        role = (await read_body(request, _Invitation)).role
        if role is Role.DRIVE:
            demand_drive(request)
        if not self._invitations.allows(request[SESSION][0], time.monotonic()):
            raise web.HTTPTooManyRequests(text="too many links, try again in a minute\n")
        self._log(f"{request.remote} ({request[SESSION][1].name}): makes a link that may {role.value}")
        link = link_to(self._find_address(request), self._gate.invite(role))
        return web.json_response({"link": link, "code": draw_picture(link), "local": self._gate.is_local})

    def _find_address(self, request: web.Request) -> str:
        """Return the address of this server for another device: that of the request, unless it is this computer's."""
        host = request.headers["Host"]
        if self._gate.is_local or host.lower().removesuffix(f":{self._gate.port}") not in LOOPBACK:
            return host
        try:
            return f"{find_address()}:{self._gate.port}"
        except UserError:  # no network
            return host
