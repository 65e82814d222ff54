"""Web sockets of Foxglove and Lichtblick, connected to the server of foxglove-sdk behind the login gate.

That server accepts any client and any origin, so it listens on the loopback interface only and offers topics only:
messages that a client publishes never reach it. Goals and initial poses become requests of a page. A viewer does not
implement the challenges of the mux, but every web socket answers pings in the order of its messages: each ping carries
a challenge, and a goal proves the newest one whose pong arrived before it.
"""

from __future__ import annotations

import asyncio
import json
import secrets
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import aiohttp
from aiohttp import WSCloseCode, WSMsgType, web
from msgspec import Meta

from ur.source.foreign.json_values import Count, read_json
from ur.system.child_processes import NodeProcess, start_node
from ur.web.access.rate import draw, make_bucket
from ur.web.access.roles import Role
from ur.web.server.drivers import DrivingPages
from ur.web.server.logins.gate import SESSION
from ur.web.server.viewers import limit_buffer
from ur.web.wire.reading import BadRequestError
from ur.web.wire.viewer_protocol import (
    LONGEST,
    SCHEMAS,
    SUBPROTOCOLS,
    UPSTREAM,
    AdvertisedTopic,
    Advertisement,
    Publication,
    SubscriptionMessage,
    Withdrawal,
    complete_server_info,
    read_message,
    read_request_of,
    write_status,
)

if TYPE_CHECKING:
    Topics = aiohttp.ClientWebSocketResponse[bool]

_MODULE = "ur_nodes.web.viewers.viewer_endpoint_node"
_START_LIMIT = 20.0  # s


@dataclass(frozen=True, slots=True)
class _Address:
    host: Annotated[str, Meta(pattern=r"^127\.[0-9.]{1,12}\Z")]
    port: Annotated[int, Meta(gt=0, lt=1 << 16)]


class ViewerProcessError(Exception):
    """The process does not start; the text is the reason, in one line."""


class ViewerProcess:
    """Keeps the process running while a client holds it. `log` is called with its output."""

    def __init__(self, environment: Mapping[str, str], log: Callable[[str], None]) -> None:
        self._environment, self._log = environment, log
        self._lock = asyncio.Lock()
        self._holders = 0
        self._node: NodeProcess | None = None
        self._address = ("", 0)

    @asynccontextmanager
    async def hold(self) -> AsyncIterator[tuple[str, int]]:
        """Keep the process running while the context lasts, and yield its loopback address.

        Raises ViewerProcessError.
        """
        self._holders += 1
        try:
            async with self._lock:
                if self._node is None or self._node.process.returncode is not None:
                    await self._end()
                    await self._start()
            yield self._address
        finally:
            self._holders -= 1
            async with self._lock:
                if not self._holders:
                    await self._end()

    async def _start(self) -> None:
        self._node = await start_node(_MODULE, self._environment, lambda line: self._log(f"viewers: {line}"))
        try:
            line = await asyncio.wait_for(self._node.links[0][0].readline(), _START_LIMIT)
            address = read_json(line, _Address)
        except (OSError, ValueError, asyncio.TimeoutError):
            await self._end()
            raise ViewerProcessError("the topics of the robot cannot be offered; see web.log") from None
        self._address = address.host, address.port

    async def _end(self) -> None:
        node, self._node = self._node, None
        if node is not None:
            await node.close()


_MOST_VIEWERS = 8
_MOST_TOPICS = 100  # that a viewer advertises
_PING_EVERY = 0.2  # s
_HELD = 3.0  # s that a request waits for the first challenge of the mux
_MOST_PINGS = 50  # unanswered pings: the viewer has disconnected
_RATE, _BURST = 50.0, 500.0  # messages of one viewer, a second
_GOAL_RATE, _GOAL_BURST = 2.0, 10.0  # goals and poses of one viewer, a second: each is logged, here and by navigation
_MOST_BAD = 20
_EXPECTED = f"expected {' or '.join(SCHEMAS)}; drive by hand on the page of 'ur web', whose commands prove their age"
_REASONS = {"driver": "another one drives, take over on the page of 'ur web'", "late": "the connection was too slow"}


@dataclass(frozen=True, slots=True)
class _Challenge:
    n: list[Count]


class _Viewer:
    """One viewer with the right to publish; it is a driver like a page."""

    def __init__(self, socket: web.WebSocketResponse) -> None:
        self.socket = socket
        self.client = f"web-{secrets.token_hex(8)}"
        self.topics: dict[int, AdvertisedTopic] = {}
        self.proved: list[int] | None = None
        self.goals = make_bucket(_GOAL_RATE, _GOAL_BURST, time.monotonic())
        self.held: tuple[dict[str, object], float] | None = None  # a request that waits for a proof, until when
        self._newest: list[int] | None = None
        self._pings: dict[bytes, list[int] | None] = {}
        self._answers: set[asyncio.Task[None]] = set()

    def challenge(self, text: str) -> None:
        """Store the newest challenge."""
        self._newest = read_json(text, _Challenge).n

    def answer(self, value: Mapping[str, object]) -> None:
        """Show a refusal of the robot's process to the user of the viewer."""
        if value.get("t") == "refused":
            reason = str(value.get("why"))
            self.show(f"{value.get('what')} refused: {_REASONS.get(reason, reason)}")

    def show(self, text: str) -> None:
        """Show a line to the user of the viewer."""
        task = asyncio.create_task(self._send(write_status("error", text)))
        self._answers.add(task)
        task.add_done_callback(self._answers.discard)

    async def _send(self, text: str) -> None:
        with suppress(ConnectionError):
            await self.socket.send_str(text)

    async def ping(self) -> None:
        """Send challenges until the viewer disconnects."""
        with suppress(ConnectionError):
            while not self.socket.closed and len(self._pings) < _MOST_PINGS:
                mark = secrets.token_bytes(8)
                self._pings[mark] = self._newest
                await self.socket.ping(mark)
                await asyncio.sleep(_PING_EVERY)

    def on_pong(self, mark: bytes) -> bool:
        """Process the answer to a ping. Return whether it proves a newer challenge."""
        if mark not in self._pings:
            return False
        stamp = self._pings[mark]
        while next(iter(self._pings)) != mark:  # earlier ones are answered as well, or never will be
            del self._pings[next(iter(self._pings))]
        del self._pings[mark]
        if stamp is None or stamp == self.proved:
            return False
        self.proved = stamp
        return True


class ViewerGate:
    """All viewers. `send` forwards a request to the robot's process, `is_up` returns whether that is running."""

    def __init__(
        self,
        environment: Mapping[str, str],
        drivers: DrivingPages,
        send: Callable[[Mapping[str, object]], None],
        is_up: Callable[[], bool],
        log: Callable[[str], None],
    ) -> None:
        self._end = ViewerProcess(environment, log)
        self._drivers, self._send, self._is_up, self._log = drivers, send, is_up, log
        self._sockets: set[web.WebSocketResponse] = set()
        self._coming = 0

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all viewers."""
        return list(self._sockets)

    async def serve(self, request: web.Request) -> web.StreamResponse:
        """Serve a viewer, whose session has been checked, until it disconnects."""
        offered = {each.strip() for each in request.headers.get("Sec-WebSocket-Protocol", "").split(",")}
        if not offered & set(SUBPROTOCOLS):
            raise web.HTTPBadRequest(text=f"expected a web socket with the protocol {' or '.join(SUBPROTOCOLS)}\n")
        if not self._is_up():
            raise web.HTTPServiceUnavailable(text="the robot is not connected: start a program of it\n")
        if self._coming >= _MOST_VIEWERS:
            raise web.HTTPServiceUnavailable(text=f"{_MOST_VIEWERS} viewers are connected, expected no more\n")
        self._coming += 1
        try:
            async with self._end.hold() as (host, port), aiohttp.ClientSession() as session:
                address = f"http://{host}:{port}/"
                async with session.ws_connect(address, protocols=(UPSTREAM,), max_msg_size=0) as topics:
                    return await self._join(request, topics)
        except (ViewerProcessError, aiohttp.ClientError) as problem:
            raise web.HTTPServiceUnavailable(text=f"{problem}\n") from None
        finally:
            self._coming -= 1

    async def _join(self, request: web.Request, topics: Topics) -> web.WebSocketResponse:
        session, grant = request[SESSION]
        socket = web.WebSocketResponse(
            protocols=SUBPROTOCOLS, autoping=False, compress=False, max_msg_size=LONGEST, timeout=1.0
        )
        await socket.prepare(request)
        limit_buffer(request)
        self._sockets.add(socket)
        viewer, who = _Viewer(socket), f"{request.remote} ({grant.name})"
        publish = grant.role is Role.DRIVE
        self._log(f"{who}: viewer")
        if publish:
            await self._drivers.add(viewer, grant.name, session, once=True)
        tasks = [
            asyncio.create_task(_pass_topics(topics, socket, publish=publish)),
            asyncio.create_task(self._receive(viewer, topics, who, publish=publish)),
            asyncio.create_task(viewer.ping()),
        ]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._sockets.discard(socket)
            if publish:
                self._drivers.remove(viewer)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            with suppress(ConnectionError):
                await socket.close(code=WSCloseCode.GOING_AWAY)
        return socket

    async def _receive(self, viewer: _Viewer, topics: Topics, who: str, *, publish: bool) -> None:
        """Process messages until the viewer disconnects, exceeds the rate, or sends too many malformed ones."""
        bad, bucket = 0, make_bucket(_RATE, _BURST, time.monotonic())
        async for message in viewer.socket:
            bucket, allowed = draw(bucket, time.monotonic())
            if message.type is WSMsgType.PONG and allowed:
                if viewer.on_pong(bytes(message.data)) and publish:
                    self._send({"page": viewer.client, "m": json.dumps({"t": "alive", "n": viewer.proved})})
                self._release(viewer)
                continue
            if message.type is WSMsgType.PING and allowed:
                await viewer.socket.pong(message.data)
                continue
            try:
                await self._on_data(viewer, topics, message.data, who, publish=publish)
            except BadRequestError as problem:
                bad += 1
                viewer.show(str(problem))
            if not allowed or bad > _MOST_BAD:
                self._log(f"{who}: closed: too many {'messages' if not allowed else 'malformed messages'}")
                return

    async def _on_data(self, viewer: _Viewer, topics: Topics, data: object, who: str, *, publish: bool) -> None:
        """Execute the request in a viewer's message. Raises BadRequestError."""
        found = read_message(data)
        if isinstance(found, SubscriptionMessage):
            await topics.send_str(found.text)
        elif isinstance(found, Advertisement):
            viewer.topics.update((each.number, each) for each in found.topics)
            if len(viewer.topics) > _MOST_TOPICS:
                viewer.topics.clear()
                raise BadRequestError(f"expected at most {_MOST_TOPICS} topics to publish on")
        elif isinstance(found, Withdrawal):
            for number in found.numbers:
                viewer.topics.pop(number, None)
        elif isinstance(found, Publication):
            self._publish(viewer, found, who, publish=publish)

    def _publish(self, viewer: _Viewer, publication: Publication, who: str, *, publish: bool) -> None:
        """Convert a published message to a request. Raises BadRequestError if it is malformed or not permitted."""
        if not publish:
            raise BadRequestError("this address may look, expected one of 'ur web --foxglove' without --look")
        channel = viewer.topics.get(publication.number)
        if channel is None or channel.topic not in SCHEMAS:
            raise BadRequestError(f"{channel.topic if channel else 'a topic'} is not taken from viewers, {_EXPECTED}")
        if channel.encoding != "ros1":
            raise BadRequestError(f"{channel.topic}: the encoding '{channel.encoding[:20]}', expected 'ros1'")
        asked = read_request_of(channel.topic, publication.data)
        viewer.goals, allowed = draw(viewer.goals, time.monotonic())
        if not allowed:
            raise BadRequestError(f"{channel.topic}: too many at once, expected at most {_GOAL_RATE:g} a second")
        self._log(f"{who}: {asked['t']} {asked['x']:.2f} {asked['y']:.2f} {asked['yaw']:.2f}")
        viewer.held = (asked, time.monotonic() + _HELD)
        self._release(viewer)

    def _release(self, viewer: _Viewer) -> None:
        """Send the pending request with the newest proof, which a viewer that has just connected does not have yet."""
        if viewer.held is None:
            return
        asked, until = viewer.held
        if viewer.proved is not None:
            self._send({"page": viewer.client, "m": json.dumps({**asked, "n": viewer.proved})})
        elif time.monotonic() < until:
            return
        else:
            viewer.show("the robot's mux is not heard: see 'ur doctor'")
        viewer.held = None


async def _pass_topics(topics: Topics, socket: web.WebSocketResponse, *, publish: bool) -> None:
    """Forward messages of the topic server, which drops the oldest messages of a slow viewer."""
    with suppress(ConnectionError):
        async for message in topics:
            if message.type is WSMsgType.BINARY:
                await socket.send_bytes(message.data)
            elif message.type is WSMsgType.TEXT:
                await socket.send_str(complete_server_info(message.data, publish=publish))
