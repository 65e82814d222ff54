"""Programs and runs over the web: a separate web socket for state, log and requests; documents by GET."""

import asyncio
import itertools
import json
import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress

from aiohttp import WSCloseCode, WSMsgType, web

from ur.web.access.rate import draw, make_bucket
from ur.web.access.roles import Role
from ur.web.runs.programs import Programs, ProgramsError
from ur.web.runs.watcher import CommandQueue, RunWatcher
from ur.web.server.logins.gate import SESSION
from ur.web.server.map_pages import answer_command
from ur.web.server.viewers import open_socket, receive
from ur.web.wire.reading import BadRequestError
from ur.web.wire.run_requests import (
    LONGEST,
    EndRun,
    RunRequest,
    StartProgram,
    read_node_name,
    read_program,
    read_run_request,
)

BEAT = 1.0
"""Seconds between two beats of the server."""

OLDEST = 5.0
"""Seconds after which a beat is no proof that a request is fresh."""

_STATE_PERIOD = 0.25  # s: the minimum between two states sent to a page
_MOST_LINES = 200  # of a log in one message
_RATE, _BURST = 5.0, 20.0  # requests of one page, a second
_MOST_BAD = 20


class _Viewer:
    """A page that shows runs, and the data it has received."""

    def __init__(self, socket: web.WebSocketResponse, oldest: float) -> None:
        self.socket, self._oldest = socket, oldest
        self.due = asyncio.Event()
        self.due.set()
        self.answers: list[dict[str, object]] = []
        self.beats: dict[int, float] = {}
        self._numbers = itertools.count(1)
        self._cursors: dict[str, int] = {}
        self._state = ""

    def is_fresh(self, beat: int) -> bool:
        """Return whether the server sent this beat to the page a moment ago."""
        return time.monotonic() - self.beats.get(beat, -math.inf) < self._oldest

    def answer(self, number: int, text: str, *, ok: bool) -> None:
        """Queue an answer."""
        self.answers.append({"t": "answer", "id": number, "ok": ok, "text": text})
        self.due.set()

    async def run(self, watcher: RunWatcher) -> None:
        """Send beats, answers, state and log until the page disconnects: always the newest state, never a queue."""
        beaten = 0.0
        with suppress(ConnectionError):
            while not self.socket.closed:
                now = time.monotonic()
                if now - beaten >= BEAT:
                    beaten = now
                    await self._send(self._beat(now))
                while self.answers:
                    await self._send(self.answers.pop(0))
                state = watcher.describe()
                if (text := json.dumps(state)) != self._state:
                    self._state = text
                    await self.socket.send_str(text)
                messages = []
                logs = watcher.lines()
                self._cursors = {run: self._cursors.get(run, 0) for run in logs}
                for run, lines in logs.items():
                    first, found = lines.since(self._cursors[run], _MOST_LINES)
                    if not found:
                        continue
                    self._cursors[run] = first + len(found)
                    rows = [[each.node, each.severity, each.text] for each in found]
                    messages.append({"t": "log", "run": run, "first": first, "lines": rows})
                    if self._cursors[run] < lines.end:
                        self.due.set()
                for message in messages:
                    await self._send(message)
                self.due.clear()
                await asyncio.sleep(_STATE_PERIOD)
                with suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(self.due.wait(), max(0.0, beaten + BEAT - time.monotonic()))

    def _beat(self, now: float) -> dict[str, object]:
        number = next(self._numbers)
        self.beats = {each: at for each, at in self.beats.items() if now - at < self._oldest} | {number: now}
        return {"t": "beat", "n": number}

    async def _send(self, message: Mapping[str, object]) -> None:
        await self.socket.send_str(json.dumps(message))


class RunPages:
    """The routes and their dependencies. `log` is called with a line about each action."""

    def __init__(
        self,
        environment: Mapping[str, str],
        log: Callable[[str], None],
        *,
        oldest: float = OLDEST,
        pace: tuple[float, float] = (_RATE, _BURST),
    ) -> None:
        """Create the pages. A beat is valid for `oldest` s; `pace` is a page's rate of requests, 1/s, and its burst."""
        self._log, self._oldest, self._pace = log, oldest, pace
        self._viewers: set[_Viewer] = set()
        self._watcher = RunWatcher(environment, self._wake)
        self._programs = Programs(CommandQueue(environment))
        self._working: set[asyncio.Task[None]] = set()

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [
            web.get("/ws/runs", self._serve_runs),
            web.get("/api/programs", self._list),
            web.get("/api/graph", self._draw),
            web.get("/api/nodes", self._list_nodes),
            web.get("/api/explain", self._explain),
            web.get("/api/doctor", self._diagnose),
        ]

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all pages."""
        return [each.socket for each in self._viewers]

    async def close(self) -> None:
        """End commands in progress by an interrupt; runs continue."""
        for task in self._working:
            task.cancel()
        await asyncio.gather(*self._working, return_exceptions=True)
        self._watcher.close()

    def _wake(self) -> None:
        for viewer in self._viewers:
            viewer.due.set()

    async def _serve_runs(self, request: web.Request) -> web.WebSocketResponse:
        _, grant = request[SESSION]
        socket = await open_socket(request, LONGEST)
        viewer = _Viewer(socket, self._oldest)
        self._viewers.add(viewer)
        self._watcher.hold()
        sending = asyncio.create_task(viewer.run(self._watcher))
        try:
            await self._receive(viewer, grant.role, f"{request.remote} ({grant.name})", grant.name)
        finally:
            self._viewers.discard(viewer)
            self._watcher.let_go()
            sending.cancel()
        return socket

    async def _receive(self, viewer: _Viewer, role: Role, who: str, name: str) -> None:
        bad, bucket = 0, make_bucket(*self._pace, time.monotonic())
        async for message in receive(viewer.socket):
            bucket, allowed = draw(bucket, time.monotonic())
            try:
                envelope = read_run_request(message.data if message.type is WSMsgType.TEXT else None)
            except BadRequestError:
                bad += 1
                if allowed and bad <= _MOST_BAD:
                    continue
                allowed = False
            if not allowed:
                self._log(f"{who}: runs: closed: too many messages")
                await viewer.socket.close(code=WSCloseCode.POLICY_VIOLATION)
                return
            if role is not Role.DRIVE:
                viewer.answer(envelope.number, "this login may look, expected one that may drive", ok=False)
            elif not viewer.is_fresh(envelope.beat):
                viewer.answer(envelope.number, "the connection was too slow, nothing was done; try again", ok=False)
            else:
                self._log(f"{who}: {message.data}")
                self._carry_out(viewer, envelope.number, envelope.request, name)

    def _carry_out(self, viewer: _Viewer, number: int, request: RunRequest, who: str) -> None:
        if isinstance(request, StartProgram):
            task = asyncio.create_task(self._start(viewer, number, request))
            self._working.add(task)
            task.add_done_callback(self._working.discard)
            return
        if isinstance(request, EndRun):
            problem = self._watcher.end_run(request.run, who)
        else:
            problem = self._watcher.change_node(request)
        viewer.answer(number, problem, ok=not problem)

    async def _start(self, viewer: _Viewer, number: int, request: StartProgram) -> None:
        try:
            run = await self._programs.start(request)
        except ProgramsError as problem:
            viewer.answer(number, str(problem), ok=False)
        else:
            viewer.answer(number, run, ok=True)

    async def _list(self, _request: web.Request) -> web.Response:
        return web.json_response(await answer_command(self._programs.list_all()))

    async def _draw(self, request: web.Request) -> web.Response:
        picture = await answer_command(self._programs.draw(*_read_query(request)))
        return web.Response(text=picture, content_type="image/svg+xml")

    async def _list_nodes(self, request: web.Request) -> web.Response:
        return web.json_response(await answer_command(self._programs.list_nodes(*_read_query(request))))

    async def _explain(self, request: web.Request) -> web.Response:
        query = _read_query(request)
        try:
            node = read_node_name(request.query.get("node"))
        except BadRequestError as problem:
            raise web.HTTPBadRequest(text=f"node: {problem}\n") from None
        return web.Response(text=await answer_command(self._programs.explain(*query, node)))

    async def _diagnose(self, _request: web.Request) -> web.Response:
        return web.json_response(await answer_command(self._programs.diagnose()))


def _read_query(request: web.Request) -> tuple[str, Mapping[str, str]]:
    """Return the program and the arguments (JSON) of a query; without the right to drive, only default arguments.

    An argument may name any file, and a message about that file shows a part of it. Raises HTTPBadRequest,
    HTTPForbidden.
    """
    try:
        asked = read_program(request.query.get("program"), request.query.get("arguments", "{}"))
    except BadRequestError as problem:
        raise web.HTTPBadRequest(text=f"{problem}\n") from None
    if asked.arguments and request[SESSION][1].role is not Role.DRIVE:
        raise web.HTTPForbidden(text="this login may look at the default values, expected no arguments\n")
    return asked.program, asked.arguments
