"""Data of the robot for pages: web sockets whose requests are checked here, and the process that answers them."""

import asyncio
import gzip
import importlib
import itertools
import json
import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from aiohttp import WSCloseCode, WSMsgType, web

from ur.system.child_processes import start_node
from ur.web.access.rate import draw, make_bucket
from ur.web.runs.watcher import CommandQueue
from ur.web.server.logins.gate import SESSION
from ur.web.server.robot_process import read_frames
from ur.web.server.viewers import open_socket, receive
from ur.web.wire.data_requests import ALL, LONGEST, DataFrame, Show, find_number, read_data_request, unpack_frame
from ur.web.wire.reading import BadRequestError

_PACKAGE, _SCRIPT = "jupyter_threejs_sage", "static/r130/three.min.js"
_INSTALL_LIMIT = 300.0  # s
_HEADERS = {"Content-Type": "text/javascript; charset=utf-8", "Cache-Control": "no-cache"}


def find_script() -> Path | None:
    """Find the file of three.js; None if its package is not installed."""
    importlib.invalidate_caches()  # it may have been installed since
    found = find_spec(_PACKAGE)
    folders = found.submodule_search_locations if found is not None else None
    path = Path(folders[0], _SCRIPT) if folders else None
    return path if path is not None and path.is_file() else None


class ThreeScript:
    """Serves the script; `commands` runs the command that installs it."""

    def __init__(self, commands: CommandQueue, find: Callable[[], Path | None] = find_script) -> None:
        self._commands, self._find = commands, find
        self._lock = asyncio.Lock()
        self._packed: bytes | None = None

    async def serve(self, request: web.Request) -> web.Response:
        """Respond with the script. Raises HTTPServiceUnavailable if it cannot be installed."""
        async with self._lock:
            if self._packed is None:
                path = self._find() or await self._install()
                compress = partial(gzip.compress, path.read_bytes(), 9, mtime=0)
                self._packed = await asyncio.get_running_loop().run_in_executor(None, compress)
        headers = {**_HEADERS, "ETag": f'"{_PACKAGE}-{_SCRIPT}"'}
        if request.headers.get("If-None-Match") == headers["ETag"]:
            return web.Response(status=304, headers=headers)
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            return web.Response(body=self._packed, headers={**headers, "Content-Encoding": "gzip"})
        return web.Response(body=gzip.decompress(self._packed), headers=headers)

    async def _install(self) -> Path:
        done = await self._commands.run("web", "--prepare-3d", limit=_INSTALL_LIMIT)
        path = self._find()
        if path is None:
            lines = [line for line in done.err.splitlines() if line.startswith("error: ")] or ["error: no answer"]
            text = f"the 3D view cannot be installed: {lines[-1].removeprefix('error: ')[:300]}\n"
            raise web.HTTPServiceUnavailable(text=text)
        return path


_MODULE = "ur_nodes.web.data.data_endpoint_node"
_PAUSE = 1.0  # s before it is started again
_WAITING = 1 << 20  # bytes of requests that the process has not read

State = Literal["off", "starting", "up"]


class DataProcess:
    """Keeps the process running between `open` and `close`.

    `on_start` is called before its first frame. `is_up` returns whether the robot is connected: without a master the
    process would not start.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        is_up: Callable[[], bool],
        on_frame: Callable[[DataFrame], None],
        on_start: Callable[[], None],
        log: Callable[[str], None],
    ) -> None:
        self._environment, self._is_up = environment, is_up
        self._on_frame, self._on_start, self._log = on_frame, on_start, log
        self._link: asyncio.StreamWriter | None = None
        self._task: asyncio.Task[None] | None = None
        self.state: State = "off"
        self.pid = 0

    def open(self) -> None:
        """Keep the process running from now on."""
        if self._task is None:
            self.state = "starting"
            self._task = asyncio.create_task(self._run())

    async def close(self) -> None:
        """End the process."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        if self._task is None:
            self.state = "off"

    def send(self, page: int, text: str) -> bool:
        """Forward a request of a page, or "" when the page has disconnected. Return whether the process accepts it."""
        if self._link is None or self._link.transport.get_write_buffer_size() > _WAITING:
            return False
        self._link.write(json.dumps({"page": page, "m": text}).encode() + b"\n")
        return True

    async def _run(self) -> None:
        while True:
            if self._is_up():
                await self._run_once()
                self.state = "starting"
            await asyncio.sleep(_PAUSE)

    async def _run_once(self) -> None:
        node = await start_node(_MODULE, self._environment, lambda line: self._log(f"data: {line}"))
        self.pid = node.process.pid
        ((reader, link),) = node.links
        self._link = link
        try:
            self._on_start()
            with suppress(ValueError):
                async for body in read_frames(reader):
                    frame = unpack_frame(body)
                    self.state = "up"
                    self._on_frame(frame)
        finally:
            if self._link is link:
                self._link = None
            await asyncio.shield(node.close())


BEAT = 1.0
"""Seconds between two beats of the server."""

_RATE, _BURST = 10.0, 40.0  # requests of one page, a second
_MOST_BAD = 20
_MOST_ANSWERS = 100
_MOST_PAGES = 20
_UNUSED = 3.0  # s without a page after which the process ends


class _Page:
    """A page: its request, and the frames that are not yet sent to it."""

    def __init__(self, number: int, socket: web.WebSocketResponse) -> None:
        self.number, self.socket = number, socket
        self.shows = ""
        self.due = asyncio.Event()
        self._newest: dict[str, bytes] = {}
        self._answers: list[bytes] = []
        self._numbers = itertools.count(1)

    def put(self, frame: DataFrame) -> None:
        """Queue a frame: in place of the one with the same key, or, without a key, after all others."""
        if frame.key:
            self._newest[frame.key] = frame.body
        else:
            self._answers = [*self._answers[1 - _MOST_ANSWERS :], frame.body]
        self.due.set()

    def answer(self, number: int, text: str) -> None:
        """Queue a refusal."""
        value = {"t": "answer", "id": number, "ok": False, "text": text}
        self.put(DataFrame(self.number, "", json.dumps(value).encode()))

    async def run(self, describe: Callable[[], Mapping[str, object]]) -> None:
        """Send beats, answers, and the newest frame of each key until the page disconnects."""
        beaten = -math.inf
        with suppress(ConnectionError):
            while not self.socket.closed:
                now = time.monotonic()
                if now - beaten >= BEAT:
                    beaten = now
                    await self.socket.send_str(json.dumps({"t": "beat", "n": next(self._numbers), **describe()}))
                elif self._answers:
                    await self._send(self._answers.pop(0))
                elif self._newest:
                    await self._send(self._newest.pop(next(iter(self._newest))))
                else:
                    self.due.clear()
                    with suppress(asyncio.TimeoutError):
                        await asyncio.wait_for(self.due.wait(), max(0.0, beaten + BEAT - now))

    async def _send(self, body: bytes) -> None:
        if body.startswith(b"{"):
            await self.socket.send_str(body.decode("utf-8", "replace"))
        else:
            await self.socket.send_bytes(body)


class DataPages:
    """The route and its dependencies. `is_up` returns whether the robot is connected; `log` is called with a line."""

    def __init__(self, environment: Mapping[str, str], is_up: Callable[[], bool], log: Callable[[str], None]) -> None:
        self._log = log
        self._pages: dict[int, _Page] = {}
        self._numbers = itertools.count(ALL + 1)
        self._end = DataProcess(environment, is_up, self._handle_frame, self._show_again, log)
        self._ending: asyncio.Task[None] | None = None
        self._three = ThreeScript(CommandQueue(environment))

    def routes(self) -> list[web.RouteDef]:
        """Return the routes."""
        return [web.get("/ws/data", self._serve), web.get("/three.js", self._three.serve)]

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all pages."""
        return [each.socket for each in self._pages.values()]

    async def close(self) -> None:
        """End the process."""
        if self._ending is not None:
            self._ending.cancel()
        await self._end.close()

    def _handle_frame(self, frame: DataFrame) -> None:
        pages = self._pages.values() if frame.page == ALL else filter(None, [self._pages.get(frame.page)])
        for page in pages:
            page.put(frame)

    def _show_again(self) -> None:
        """Send the requests of all pages to a new process."""
        for page in self._pages.values():
            if page.shows:
                self._end.send(page.number, page.shows)

    def _describe(self) -> Mapping[str, object]:
        return {"end": self._end.state}

    async def _serve(self, request: web.Request) -> web.WebSocketResponse:
        if len(self._pages) >= _MOST_PAGES:
            raise web.HTTPServiceUnavailable(text=f"{_MOST_PAGES} pages show data, expected no more\n")
        _, grant = request[SESSION]
        socket = await open_socket(request, LONGEST)
        page = _Page(next(self._numbers), socket)
        self._pages[page.number] = page
        self._end.open()
        sending = asyncio.create_task(page.run(self._describe))
        try:
            await self._receive(page, f"{request.remote} ({grant.name})")
        finally:
            del self._pages[page.number]
            self._end.send(page.number, "")
            sending.cancel()
            if self._ending is None or self._ending.done():
                self._ending = asyncio.create_task(self._end_unused())
        return socket

    async def _end_unused(self) -> None:
        await asyncio.sleep(_UNUSED)
        if not self._pages:
            await self._end.close()
            if self._pages:  # a page that has connected meanwhile
                self._end.open()

    async def _receive(self, page: _Page, who: str) -> None:
        bad, bucket = 0, make_bucket(_RATE, _BURST, time.monotonic())
        async for message in receive(page.socket):
            bucket, allowed = draw(bucket, time.monotonic())
            text = message.data if message.type is WSMsgType.TEXT else None
            try:
                envelope = read_data_request(text)
            except BadRequestError as problem:
                bad += 1
                if allowed and bad <= _MOST_BAD:
                    page.answer(find_number(text), str(problem))
                    continue
                allowed = False
            if not allowed:
                self._log(f"{who}: data: closed: too many messages")
                await page.socket.close(code=WSCloseCode.POLICY_VIOLATION)
                return
            if isinstance(envelope.request, Show):
                page.shows = str(text)
            if not self._end.send(page.number, str(text)) and envelope.number:
                page.answer(envelope.number, "the robot is not connected: start a program of it")
