"""Login gate for every request: it checks host, origin, session and role, and sets the headers of every response."""

import time
from collections.abc import Callable, Collection
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TypeVar
from urllib.parse import parse_qs

from aiohttp import web
from aiohttp.typedefs import Handler, Middleware

from ur.source.foreign.json_values import BadJsonError, read_json
from ur.web.access.origin import LOOPBACK, Head, Origins, allows_host, allows_origin, allows_viewer, find_cookies
from ur.web.access.rate import Buckets
from ur.web.access.roles import SESSION_LIFE, Grant, Role
from ur.web.server.links import LinkFiles
from ur.web.server.logins.sessions import Sessions, discard_line

Body = TypeVar("Body")

_NAMES = (
    ("iphone", "iPhone"),
    ("ipad", "iPad"),
    ("cros", "Chromebook"),
    ("android", "Android"),
    ("windows", "Windows"),
    ("macintosh", "Mac"),
    ("linux", "Linux"),
)

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

_OPEN = frozenset({"/login", "/login.js", "/loading.js", "/style.css", "/texts.js", "/icon.svg"})
_LOGIN_RATE, _LOGIN_BURST = 0.2, 10.0
_REQUEST_RATE, _REQUEST_BURST = 50.0, 200.0  # of a session
_FILE_RATE, _FILE_BURST = 500.0, 1500.0  # of a session, for files of the page: loading it requests dozens
_LONGEST_QUERY = 500  # characters
_MOST_AHEAD = 8  # requests that wait on a connection for this answer: browsers send one after the other
_UNLIMITED = frozenset({"/api/stop", "/ws/drive"})


class LoginGate:
    """Checks requests. Sessions are stored in a file that only the user can read, so that they survive a restart."""

    def __init__(
        self,
        origins: Origins,
        sessions: Path,
        log: Callable[[str], None],
        links: LinkFiles | None = None,
        viewer_origins: Collection[str] = (),
        report: Callable[[str], None] = discard_line,
        life: float = SESSION_LIFE,
        *,
        pace: tuple[float, float] = (_REQUEST_RATE, _REQUEST_BURST),
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Load the sessions. `links` were made by other commands; `viewer_origins` are additional origins of viewers.

        `report` is called with a line about each login, which is valid for `life` s. `pace` is a session's rate of
        requests, 1/s, and its burst.
        """
        self._origins, self._log = origins, log
        self._viewer_origins = frozenset(viewer_origins)
        self.sessions = Sessions(sessions, log, links, report, life, clock)
        self._logins = Buckets(_LOGIN_RATE, _LOGIN_BURST)  # failed ones, by address
        self._requests = Buckets(*pace)  # by session
        self._files = Buckets(_FILE_RATE, _FILE_BURST)  # by session

    @property
    def cookie(self) -> str:
        """The name of the cookie, which contains the port: servers on several ports of one host share their cookies."""
        return f"ur_web_{self._origins.port}"

    @property
    def port(self) -> int:
        """The port of the server."""
        return self._origins.port

    @property
    def is_local(self) -> bool:
        """True if only this computer reaches the server."""
        return self._origins.names <= LOOPBACK

    def invite(self, role: Role) -> str:
        """Create a token for one login."""
        return self.sessions.invite(role)

    def log_in(self, request: web.Request, token: object) -> web.Response:
        """Respond to a login: a cookie for a valid token. Only attempts with invalid tokens are rate-limited."""
        name = name_device(request.headers.get("User-Agent"))
        before = self.sessions.find(request.cookies.get(self.cookie))
        secret = self.sessions.log_in(token, name, request.remote or "", before[0] if before else "")
        if secret is None:
            if not self._logins.allows(request.remote or "", time.monotonic()):
                raise web.HTTPTooManyRequests(text="too many logins, try again in a minute\n")
            self._log(f"{request.remote}: login refused: the link was used before or is too old")
            raise web.HTTPForbidden(text="this link was used before, or is too old\n")
        answer = web.json_response({"ok": True})
        life = int(self.sessions.life)
        answer.set_cookie(self.cookie, secret, httponly=True, samesite="Strict", path="/", max_age=life)
        return answer

    def log_out(self, request: web.Request) -> web.Response:
        """End the session of a request."""
        self.sessions.end([request[SESSION][0]])
        answer = web.json_response({"ok": True})
        answer.del_cookie(self.cookie, path="/")
        return answer

    def middleware(self) -> Middleware:
        """The middleware that checks every request."""

        @web.middleware
        async def check(request: web.Request, handler: Handler) -> web.StreamResponse:
            try:
                self._check(request)
                with self._hold(request):
                    answer = await handler(request)
            except web.HTTPRedirection as elsewhere:
                answer = web.Response(status=elsewhere.status, headers={"Location": elsewhere.headers["Location"]})
            except web.HTTPException as refusal:
                answer = web.Response(status=refusal.status, text=refusal.text)
            ahead = request.protocol._messages  # noqa: SLF001  # aiohttp keeps no count, and bounds them late
            if SESSION not in request or len(ahead) > _MOST_AHEAD:
                answer.force_close()
            if not answer.prepared:
                answer.headers.update(HEADERS)
                answer.headers.setdefault("Cache-Control", "no-store")
            return answer

        return check

    def _check(self, request: web.Request) -> None:
        host, path = request.headers.get("Host"), request.path
        name = request.transport.get_extra_info("sockname") if request.transport else None
        if not allows_host(self._origins, host, (str(name[0]) if name else "")):
            raise web.HTTPMisdirectedRequest(text="expected the host name of this server\n")
        if path == VIEWER_PATH:
            # Check a viewer's request, which has no cookie: its address contains the secret
            found = self.sessions.find_viewer(request.query.get("token"))
            if found is None:
                text = "expected the address that 'ur web --foxglove' has printed; it ends with the server\n"
                raise web.HTTPForbidden(text=text)
            origin = request.headers.get("Origin")
            if not allows_viewer(request.headers.get("Host"), origin, self._viewer_origins):
                self._log(f"{request.remote}: viewer refused: origin {origin}")
                raise web.HTTPForbidden(text="this origin is not allowed, see --foxglove-origin of 'ur web'\n")
            request[SESSION] = found
            self._limit(request)
            return
        site, mode = request.headers.get("Sec-Fetch-Site", "none"), request.headers.get("Sec-Fetch-Mode", "")
        if site not in ("none", "same-origin") and mode != "navigate":
            raise web.HTTPForbidden(text="expected a request of the page itself\n")
        if (request.method != "GET" or path.startswith("/ws/")) and not allows_origin(
            host, request.headers.get("Origin")
        ):
            raise web.HTTPForbidden(text="expected a request of the page itself\n")
        if path in _OPEN:
            return
        secret = request.cookies.get(self.cookie)
        session = self.sessions.find(secret)
        if session is None or secret is None:
            if request.method == "GET" and "text/html" in request.headers.get("Accept", ""):
                raise web.HTTPSeeOther("/login")  # the message tells the user what to do
            raise web.HTTPForbidden(text="log in first: open the link that 'ur web' has printed\n")
        self.sessions.note_use(secret)
        request[SESSION] = session
        if path not in _UNLIMITED:
            self._limit(request)

    def _hold(self, request: web.Request) -> AbstractContextManager[None]:
        """Close a connection that stays open when its session ends. That of a viewer ends with the server."""
        if SESSION not in request or not request.path.startswith("/ws/"):
            return nullcontext()
        return self.sessions.hold(request[SESSION][0], request.transport)

    def _limit(self, request: web.Request) -> None:
        """Refuse a request of a session that exceeds its rate, without effect on others. Raises HTTPTooManyRequests."""
        buckets = self._requests if request.path.startswith(("/api/", "/ws/", VIEWER_PATH)) else self._files
        if not buckets.allows(request[SESSION][0], time.monotonic()):
            raise web.HTTPTooManyRequests(text="too many requests\n")

    def recognise(self, head: Head) -> bool:
        """Return whether a request's head contains the secret of a session or of a viewer link. It is fast."""
        if any(self.sessions.find(each) for each in find_cookies(head, self.cookie)):
            return True
        path, _, query = head.target.decode("latin-1").partition("?")
        if path != VIEWER_PATH or len(query) > _LONGEST_QUERY:
            return False
        return any(self.sessions.find_viewer(each) for each in parse_qs(query).get("token", ())[:1])


def demand_drive(request: web.Request) -> None:
    """Refuse a request of a session without the right to drive. Raises HTTPForbidden."""
    if request[SESSION][1].role is not Role.DRIVE:
        raise web.HTTPForbidden(text="this login may look, expected one that may drive\n")


async def read_body(request: web.Request, kind: type[Body]) -> Body:
    """Parse the JSON body of a request to a type. Raises HTTPBadRequest."""
    try:
        return read_json(await request.read(), kind)
    except BadJsonError as problem:
        raise web.HTTPBadRequest(text=f"{problem}\n") from None


def name_device(user_agent: str | None) -> str:
    """Return the device that a User-Agent header names; `a browser` if it names none."""
    text = (user_agent or "")[:1000].lower()
    return next((name for mark, name in _NAMES if mark in text), "a browser")
