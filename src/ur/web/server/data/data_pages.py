"""Web sockets of pages that show data of the robot: requests are checked here, and answered by the robot's process."""

import asyncio
import itertools
import json
import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress

from aiohttp import WSCloseCode, WSMsgType, web

from ur.web.access.rate import draw, make_bucket
from ur.web.runs.commands import CommandQueue
from ur.web.server.data.data_process import DataProcess
from ur.web.server.data.three import ThreeScript
from ur.web.server.logins.gate import SESSION
from ur.web.server.viewers import open_socket, receive
from ur.web.wire.data_frames import ALL, DataFrame
from ur.web.wire.data_requests import LONGEST, Show, find_number, read_data_request
from ur.web.wire.reading import BadRequestError

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
        self._end = DataProcess(environment, is_up, self._take, self._show_again, log)
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

    def _take(self, frame: DataFrame) -> None:
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
