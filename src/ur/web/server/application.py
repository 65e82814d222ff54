"""Routes of the page: files, login, the two web sockets, and a few other requests."""

import asyncio
import hashlib
import re
import time
from collections.abc import AsyncIterator, Callable, Mapping

from aiohttp import WSCloseCode, WSMsgType, web

from ur.web.access.rate import Buckets, draw, make_bucket
from ur.web.access.roles import Role
from ur.web.runs.watcher import CommandQueue
from ur.web.server.assistant_pages import AssistantPages
from ur.web.server.data.data_pages import DataPages
from ur.web.server.drivers import DrivingPage, DrivingPages, describe_request
from ur.web.server.logins.gate import SESSION, VIEWER_PATH, LoginGate, demand_drive, read_body
from ur.web.server.logins.session_pages import SessionPages
from ur.web.server.map_pages import MapPages
from ur.web.server.recordings.recording_pages import RecordingPages
from ur.web.server.robot_process import RobotProcess
from ur.web.server.run_pages import RunPages
from ur.web.server.static_files import StaticFile
from ur.web.server.viewer_gate import ViewerGate
from ur.web.server.viewers import Cameras, Viewers, ViewingPage, open_socket, receive
from ur.web.wire.frames import Kind, Layer, key_of
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import LONGEST, Stick, read_request, read_view, read_view_message
from ur.web.wire.requests import LONGEST as LONGEST_VIEW

_LONGEST_BODY = 2048
_STATUS_EVERY = 0.5  # s
_CLOSE_LIMIT = 0.5  # s for pages to disconnect
_CANCEL_AGAIN = 1.0  # s
_MOST_BAD = 20  # malformed messages of one page
_RATE, _BURST = 150.0, 150.0  # messages of one page, a second
_LOG_RATE, _LOG_BURST = 2.0, 100.0  # of them are logged
_VIEW_RATE, _VIEW_BURST = 10.0, 40.0  # changes of what one page shows, a second
_STOP_LINES = (1.0, 20.0)  # stops of a session that are logged: a second, at once
_TAB = re.compile(r"[0-9a-z]{8,32}", re.ASCII)


class Application:
    """Joins the login gate, the static files, the pages and the robot's process."""

    def __init__(
        self,
        gate: LoginGate,
        files: Mapping[str, StaticFile],
        environment: Mapping[str, str],
        robot: str,
        log: Callable[[str], None],
        *,
        make_robot_process: Callable[..., RobotProcess] = RobotProcess,
        runs: RunPages | None = None,
        recordings: RecordingPages | None = None,
        commands: CommandQueue | None = None,
        assistants: AssistantPages | None = None,
        moved: Callable[[], str] = str,
    ) -> None:
        """Create the application.

        `robot` is the name of the displayed robot; `log` is called with a line about each action of a client.
        `moved`: see ServerOptions.
        """
        self._gate, self._files, self._robot, self._log = gate, files, robot, log
        self._moved, self._stop_lines = moved, Buckets(*_STOP_LINES)  # by session
        self._viewers = Viewers()
        self._drivers = DrivingPages(self._send)
        self._cameras = Cameras()
        self._runs = runs or RunPages(environment, log)
        self._devices = SessionPages(gate, self._drivers.rename, log)
        self._assistants = assistants or AssistantPages(environment, log)
        self.robot_process = make_robot_process(
            environment, self.show, self._drivers.process, self._on_start, self._on_state, log
        )
        self._foxglove = ViewerGate(environment, self._drivers, self._send, self._is_up, log)
        self._data = DataPages(environment, self._is_up, log)
        self._maps = MapPages(commands or CommandQueue(environment))
        self._recordings = recordings or RecordingPages(environment, log)

    def _is_up(self) -> bool:
        return self.robot_process.state == "up"

    def build(self) -> web.Application:
        """Return the aiohttp application."""
        app = web.Application(middlewares=[self._gate.middleware()], client_max_size=_LONGEST_BODY)
        app.add_routes(
            [
                web.get("/", self._serve_index),
                web.get("/login", self._serve_login),
                web.post("/login", self._log_in),
                web.post("/logout", self._log_out),
                web.get("/api/me", self._describe_session),
                web.post("/api/stop", self._stop),
                web.get("/ws/view", self._view),
                web.get("/ws/drive", self._drive),
                web.get("/ws/camera", self._show_camera),
                *self._runs.routes(),
                *self._data.routes(),
                *self._recordings.routes(),
                *self._maps.routes(),
                *self._devices.routes(),
                *self._assistants.routes(),
                web.get(VIEWER_PATH, self._foxglove.serve),
                web.get("/{name:([a-z_]+/)?[a-z_]+\\.[a-z]+}", self._serve_file),
            ]
        )
        app.cleanup_ctx.append(self._run)
        app.on_shutdown.append(self._close)
        return app

    async def _run(self, _app: web.Application) -> AsyncIterator[None]:
        tasks = [asyncio.create_task(self.robot_process.run()), asyncio.create_task(self._announce_often())]
        yield
        pending = set(tasks)
        while pending:  # before Python 3.12 wait_for loses a cancellation at the moment when its awaitable fails
            for task in pending:
                task.cancel()
            _, pending = await asyncio.wait(pending, timeout=_CANCEL_AGAIN)
        await asyncio.gather(*tasks, return_exceptions=True)
        self._gate.sessions.save()

    async def _close(self, _app: web.Application) -> None:
        """Close all web sockets, so that the server ends without waiting for them."""
        sockets = [
            *self._viewers.sockets(),
            *self._drivers.sockets(),
            *self._cameras.sockets(),
            *self._runs.sockets(),
            *self._data.sockets(),
            *self._foxglove.sockets(),
        ]
        closing = [asyncio.create_task(each.close(code=WSCloseCode.GOING_AWAY)) for each in sockets]
        if closing:
            await asyncio.wait(closing, timeout=_CLOSE_LIMIT)
        for each in (self._runs, self._data, self._recordings):
            await each.close()

    async def _announce_often(self) -> None:
        while True:
            self._announce()
            self._gate.sessions.poll()
            await asyncio.sleep(_STATUS_EVERY)

    def _announce(self) -> None:
        end = self.robot_process
        status = {"robot": self._robot, "end": end.state, "problem": end.problem, "master": end.master}
        self._viewers.announce({**status, "moved": self._moved(), "assistants": self._assistants.describe()})

    def _on_state(self) -> None:
        if self.robot_process.state == "no master":
            self._viewers.forget()
        self._announce()

    def show(self, frame: bytes) -> None:
        """Forward a frame to all pages. Raises ValueError for an invalid frame."""
        if key_of(frame)[0] == Kind.CAMERA:
            self._cameras.put(frame)
        else:
            self._viewers.put(frame)

    def _on_start(self) -> None:
        self._viewers.forget()
        self._drivers.come_again()
        self._look()

    def _look(self) -> None:
        camera = {Layer.CAMERA} if self._cameras.any_open() else set()
        layers, plots = self._viewers.layers() | camera, self._viewers.plots()
        self.robot_process.look(len(self._viewers), layers, plots, self._cameras.topic)

    def _send(self, message: Mapping[str, object]) -> None:
        self.robot_process.send(message)

    async def _serve_index(self, request: web.Request) -> web.Response:
        return self._serve(request, "index.html")

    async def _serve_login(self, request: web.Request) -> web.Response:
        return self._serve(request, "login.html")

    async def _serve_file(self, request: web.Request) -> web.Response:
        return self._serve(request, request.match_info["name"])

    def _serve(self, request: web.Request, name: str) -> web.Response:
        file = self._files.get(name)
        if file is None:
            raise web.HTTPNotFound(text="not found\n")
        headers = {"ETag": file.tag, "Cache-Control": "no-cache", "Content-Type": file.kind}
        if request.headers.get("If-None-Match") == file.tag:
            return web.Response(status=304, headers=headers)
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            return web.Response(body=file.packed, headers={**headers, "Content-Encoding": "gzip"})
        return web.Response(body=file.plain, headers=headers)

    async def _log_in(self, request: web.Request) -> web.Response:
        return self._gate.log_in(request, (await read_body(request, dict)).get("token"))

    async def _log_out(self, request: web.Request) -> web.Response:
        return self._gate.log_out(request)

    async def _describe_session(self, request: web.Request) -> web.Response:
        _, grant = request[SESSION]
        return web.json_response({"role": grant.role.value, "name": grant.name, "robot": self._robot})

    async def _stop(self, request: web.Request) -> web.Response:
        """Stop the robot, for every role."""
        connected = self.robot_process.state == "up"
        if connected:
            self._send({"do": "stop"})
        session, grant = request[SESSION]
        if self._stop_lines.allows(session, time.monotonic()):
            self._log(f"{request.remote} ({grant.name}): emergency stop{'' if connected else ' fails'}")
        if not connected:
            raise web.HTTPServiceUnavailable(text="the robot is not connected\n")
        return web.json_response({"ok": True})

    async def _view(self, request: web.Request) -> web.WebSocketResponse:
        try:
            shows = read_view(request.query)
        except BadRequestError as problem:
            raise web.HTTPBadRequest(text=f"{problem}\n") from None
        socket = await open_socket(request, LONGEST_VIEW)
        viewer = self._viewers.add(socket, shows)
        self._look()
        sending = asyncio.create_task(viewer.run())
        try:
            await self._change_view(viewer)
        finally:
            self._viewers.remove(viewer)
            self._look()
            sending.cancel()
        return socket

    async def _change_view(self, viewer: ViewingPage) -> None:
        """Change the displayed layers on request, until the page disconnects, exceeds the rate or sends other data."""
        bucket = make_bucket(_VIEW_RATE, _VIEW_BURST, time.monotonic())
        async for message in receive(viewer.socket):
            bucket, allowed = draw(bucket, time.monotonic())
            try:
                shows = read_view_message(message.data if allowed else None)
            except BadRequestError:
                await viewer.socket.close(code=WSCloseCode.POLICY_VIOLATION)
                return
            self._viewers.change(viewer, shows)
            self._look()

    async def _show_camera(self, request: web.Request) -> web.WebSocketResponse:
        socket = await open_socket(request, 256)
        await self._cameras.serve(socket, self._look, may_choose=request[SESSION][1].role is Role.DRIVE)
        return socket

    async def _drive(self, request: web.Request) -> web.WebSocketResponse:
        demand_drive(request)
        tab = request.query.get("tab", "")
        if _TAB.fullmatch(tab) is None:
            raise web.HTTPBadRequest(text="tab: expected 8 to 32 letters and digits\n")
        session, grant = request[SESSION]
        client = "web-" + hashlib.sha256(f"{session} {tab}".encode()).hexdigest()[:16]
        socket = await open_socket(request, LONGEST, 2048)
        driver = DrivingPage(client, socket)
        name = await self._drivers.add(driver, grant.name, session)
        driver.answer({"t": "hello", "client": client, "name": name, "role": Role.DRIVE.value})
        sending = asyncio.create_task(driver.run())
        try:
            await self._receive(socket, client, f"{request.remote} ({name})")
        finally:
            self._drivers.remove(driver)
            sending.cancel()
        return socket

    async def _receive(self, socket: web.WebSocketResponse, client: str, who: str) -> None:
        """Forward requests until the page disconnects, exceeds the rate, or sends too many malformed ones."""
        bad, bucket, hold = 0, make_bucket(_RATE, _BURST, time.monotonic()), 0
        lines = make_bucket(_LOG_RATE, _LOG_BURST, time.monotonic())
        async for message in receive(socket):
            bucket, allowed = draw(bucket, time.monotonic())
            try:
                request = read_request(message.data if message.type is WSMsgType.TEXT else None)
            except BadRequestError:
                bad += 1
                request = None
            if not allowed or bad > _MOST_BAD:
                self._log(f"{who}: closed: too many {'messages' if not allowed else 'malformed messages'}")
                await socket.close(code=WSCloseCode.POLICY_VIOLATION)
                return
            if request is None:
                continue
            if text := describe_request(request, message.data, hold):
                lines, logged = draw(lines, time.monotonic())
                if logged:
                    self._log(f"{who}: {text}")
            if isinstance(request, Stick):
                hold = request.hold
            self._send({"page": client, "m": message.data})
