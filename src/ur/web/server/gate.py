"""The gate before every request: host, origin, session and role; and the headers of every answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path

from aiohttp import web
from aiohttp.typedefs import Handler, Middleware

from ur.source.replace import PRIVATE, replace_file
from ur.web.access.browsers import name_device
from ur.web.access.origin import Origins, allows_host, allows_origin, allows_viewer
from ur.web.access.rate import draw, make_bucket
from ur.web.access.roles import (
    SESSION_LIFE,
    Grant,
    Ledger,
    Role,
    add_token,
    add_viewer,
    end_session,
    find_session,
    find_viewer,
    note_use,
    open_session,
    read_sessions,
    use_token,
    write_sessions,
)
from ur.web.server.link_files import LinkFiles

SESSION: web.RequestKey[tuple[str, Grant]] = web.RequestKey("session", tuple)
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
        "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Server": "ur",
}
VIEWER_PATH = "/foxglove"
"""The path of viewers that keep no cookie."""

_OPEN = frozenset({"/login", "/login.js", "/style.css", "/texts.js", "/icon.svg"})
_LOGIN_RATE, _LOGIN_BURST = 0.2, 10.0
_REQUEST_RATE, _REQUEST_BURST = 50.0, 200.0


class Gate:
    """Lets requests in. Sessions are kept in a file that only the user can read, so that they outlive the server."""

    def __init__(
        self,
        origins: Origins,
        sessions: Path,
        log: Callable[[str], None],
        links: LinkFiles | None = None,
        viewer_origins: Collection[str] = (),
    ) -> None:
        """`links` are those that others have made for this server; `viewer_origins` of viewers besides the known."""
        self._origins, self._path, self._log, self._links = origins, sessions, log, links
        self._viewer_origins = frozenset(viewer_origins)
        self._ledger = _load(sessions)
        now = time.monotonic()
        self._logins = make_bucket(_LOGIN_RATE, _LOGIN_BURST, now)
        self._requests = make_bucket(_REQUEST_RATE, _REQUEST_BURST, now)

    @property
    def cookie(self) -> str:
        """The name of the cookie: servers on several ports of one host share its cookies."""
        return f"ur_web_{self._origins.port}"

    def invite(self, role: Role) -> str:
        """Make a token for one login."""
        self._ledger, token = add_token(self._ledger, role, time.time())
        return token

    def invite_viewer(self, role: Role) -> str:
        """Make the secret of a viewer link."""
        self._ledger, secret = add_viewer(self._ledger, role, "Foxglove")
        return secret

    def log_in(self, request: web.Request, token: object) -> web.Response:
        """Answer a login: a cookie for a token that is valid."""
        self._logins, allowed = draw(self._logins, time.monotonic())
        if not allowed:
            raise web.HTTPTooManyRequests(text="too many logins, try again in a minute\n")
        name = name_device(request.headers.get("User-Agent"))
        self._ledger, secret = use_token(self._ledger, token, name, time.time())
        role = self._links.use(token) if secret is None and self._links is not None else None
        if role is not None:
            self._ledger, secret = open_session(self._ledger, role, name, time.time())
        if secret is None:
            self._log(f"{request.remote}: login refused: the link was used before or is too old")
            raise web.HTTPForbidden(text="this link was used before, or is too old\n")
        self._save()
        self._log(f"{request.remote}: login of {name}")
        answer = web.json_response({"ok": True})
        self._set_cookie(answer, secret)
        return answer

    def log_out(self, request: web.Request) -> web.Response:
        """End the session of a request."""
        self._ledger = end_session(self._ledger, request.cookies.get(self.cookie))
        self._save()
        answer = web.json_response({"ok": True})
        answer.del_cookie(self.cookie, path="/")
        return answer

    def middleware(self) -> Middleware:
        """The check of every request."""

        @web.middleware
        async def check(request: web.Request, handler: Handler) -> web.StreamResponse:
            try:
                self._check(request)
                answer = await handler(request)
            except web.HTTPException as refusal:
                answer = web.Response(status=refusal.status, text=refusal.text)
            if not answer.prepared:
                answer.headers.update(HEADERS)
                answer.headers.setdefault("Cache-Control", "no-store")
            return answer

        return check

    def _check(self, request: web.Request) -> None:
        host, path = request.headers.get("Host"), request.path
        if not allows_host(self._origins, host, _own_address(request)):
            raise web.HTTPMisdirectedRequest(text="expected the host name of this server\n")
        self._requests, allowed = draw(self._requests, time.monotonic())
        if not allowed:
            raise web.HTTPTooManyRequests(text="too many requests\n")
        if path == VIEWER_PATH:
            self._check_viewer(request)
            return
        if (request.method != "GET" or path.startswith("/ws/")) and not allows_origin(
            host, request.headers.get("Origin")
        ):
            raise web.HTTPForbidden(text="expected a request of the page itself\n")
        if path in _OPEN:
            return
        secret = request.cookies.get(self.cookie)
        session = find_session(self._ledger, secret, time.time())
        if session is None or secret is None:
            raise web.HTTPForbidden(text="log in first: open the link that 'ur web' has printed\n")
        ledger = note_use(self._ledger, secret, time.time())
        if ledger is not self._ledger:
            self._ledger = ledger
            self._save()
        request[SESSION] = session

    def _check_viewer(self, request: web.Request) -> None:
        """The check of a viewer, which has no cookie. Its address holds the secret."""
        found = find_viewer(self._ledger, request.query.get("token"))
        if found is None:
            text = "expected the address that 'ur web --foxglove' has printed; it ends with the server\n"
            raise web.HTTPForbidden(text=text)
        origin = request.headers.get("Origin")
        if not allows_viewer(request.headers.get("Host"), origin, self._viewer_origins):
            self._log(f"{request.remote}: viewer refused: origin {origin}")
            raise web.HTTPForbidden(text="this origin is not allowed, see --foxglove-origin of 'ur web'\n")
        request[SESSION] = found

    def _set_cookie(self, answer: web.Response, secret: str) -> None:
        answer.set_cookie(self.cookie, secret, httponly=True, samesite="Strict", path="/", max_age=int(SESSION_LIFE))

    def _save(self) -> None:
        try:
            replace_file(self._path, write_sessions(self._ledger), mode=PRIVATE, parents=True)
        except OSError as problem:
            self._log(f"{self._path}: sessions are not saved: {problem.strerror}")


def demand_drive(request: web.Request) -> None:
    """Refuse a request of a session that may only look. Raises HTTPForbidden."""
    if request[SESSION][1].role is not Role.DRIVE:
        raise web.HTTPForbidden(text="this login may look, expected one that may drive\n")


def _own_address(request: web.Request) -> str:
    """The address of this computer that the request was sent to."""
    name = request.transport.get_extra_info("sockname") if request.transport else None
    return str(name[0]) if name else ""


def _load(path: Path) -> Ledger:
    with suppress(OSError, UnicodeDecodeError):
        return read_sessions(path.read_text(encoding="utf-8"))
    return Ledger()
