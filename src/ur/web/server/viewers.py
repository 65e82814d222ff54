"""Pages that view: each gets the newest frame of every key, at the rate that its connection supports."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import suppress

from aiohttp import WSCloseCode, WSMessage, WSMsgType, web

from ur.web.access.rate import draw, make_bucket
from ur.web.wire.frames import Key, Kind, Layer, generation_of, json_frame, key_of
from ur.web.wire.layers import is_camera_topic
from ur.web.wire.requests import ViewRequest

_IN_FLIGHT = 2  # pictures that a page has not confirmed
_SHOWN = "shown"  # the message of a page that has shown a picture
_RATE, _BURST = 30.0, 60.0  # confirmations of one page, a second: twice as many as there are pictures


class _Page:
    def __init__(self, socket: web.WebSocketResponse) -> None:
        self.socket = socket
        self.newest: bytes | None = None
        self.credit = _IN_FLIGHT
        self.due = asyncio.Event()

    async def run(self) -> None:
        with suppress(ConnectionError):
            while not self.socket.closed:
                if self.newest is None or self.credit == 0:
                    self.due.clear()
                    await self.due.wait()
                    continue
                frame, self.newest = self.newest, None
                self.credit -= 1
                await self.socket.send_bytes(frame)


class Cameras:
    """All pages that show the camera. Each gets the newest picture once it has displayed the previous ones."""

    def __init__(self) -> None:
        self._pages: set[_Page] = set()
        self.topic = ""
        """The camera that a page has chosen for all pages; "" before."""

    def any_open(self) -> bool:
        """Return whether any page shows the camera."""
        return bool(self._pages)

    def put(self, frame: bytes) -> None:
        """Send a picture, in place of an older unsent one."""
        for page in self._pages:
            page.newest = frame
            page.due.set()

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all pages."""
        return [each.socket for each in self._pages]

    async def serve(self, socket: web.WebSocketResponse, on_change: Callable[[], None], *, may_choose: bool) -> None:
        """Send pictures until the page disconnects, exceeds the rate or sends an invalid text.

        A text confirms a picture, or, if the page `may_choose`, selects the camera topic for all pages. `on_change` is
        called when the page has connected, has chosen, and has disconnected.
        """
        page = _Page(socket)
        self._pages.add(page)
        on_change()
        sending = asyncio.create_task(page.run())
        try:
            bucket = make_bucket(_RATE, _BURST, time.monotonic())
            async for message in receive(socket):
                bucket, allowed = draw(bucket, time.monotonic())
                text = message.data if allowed and message.type is WSMsgType.TEXT else ""
                if text == _SHOWN:
                    page.credit = min(_IN_FLIGHT, page.credit + 1)
                    page.due.set()
                elif may_choose and is_camera_topic(text):
                    self.topic = text
                    on_change()
                else:
                    await socket.close(code=WSCloseCode.POLICY_VIOLATION)
                    return
        finally:
            self._pages.discard(page)
            on_change()
            sending.cancel()


_BUFFER = 1 << 15  # bytes buffered in this process in addition to the kernel's buffer
_HEARTBEAT = 5.0  # s between pings of a web socket
_CONTROL_RATE, _CONTROL_BURST = 2.0, 20.0  # pings and pongs of a page, a second


class ViewingPage:
    """One page and its displayed layers. Unsent frames are replaced by newer ones."""

    def __init__(self, socket: web.WebSocketResponse, shows: ViewRequest) -> None:
        self.socket, self.shows = socket, shows
        self._pending = FrameQueue()
        self._due = asyncio.Event()

    def put(self, frame: bytes) -> None:
        """Queue a frame, unless the page does not show its layer."""
        if key_of(frame)[1] not in self.shows.layers:
            return
        self._pending.put(frame)
        self._due.set()

    async def run(self) -> None:
        """Send frames until the page disconnects."""
        with suppress(ConnectionError):
            while not self.socket.closed:
                frame = self._pending.pop()
                if frame is None:
                    self._due.clear()
                    await self._due.wait()
                else:
                    await self.socket.send_bytes(frame)


class Viewers:
    """All pages that view, and the frames that a new page starts with."""

    def __init__(self) -> None:
        self._frames = FrameQueue()
        self._viewers: set[ViewingPage] = set()

    def __len__(self) -> int:
        return len(self._viewers)

    def put(self, frame: bytes) -> None:
        """Forward a frame to all pages. Raises ValueError for an invalid frame."""
        self._frames.put(frame)
        for viewer in self._viewers:
            viewer.put(frame)

    def announce(self, status: Mapping[str, object]) -> None:
        """Send the state of the server to all pages; its frames also show that the connection works."""
        frame = json_frame(Kind.SERVER, status)
        for viewer in self._viewers:
            viewer.put(frame)

    def forget(self) -> None:
        """Discard the frames, when another process of the robot starts."""
        self._frames.clear()

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all pages."""
        return [each.socket for each in self._viewers]

    def layers(self) -> frozenset[Layer]:
        """Return the layers that any page shows."""
        return frozenset(layer for each in self._viewers for layer in each.shows.layers)

    def plots(self) -> frozenset[str]:
        """Return the plots that any page shows."""
        return frozenset(plot for each in self._viewers for plot in each.shows.plots)

    def add(self, socket: web.WebSocketResponse, shows: ViewRequest) -> ViewingPage:
        """Register a page."""
        viewer = ViewingPage(socket, shows)
        for frame in self._frames:
            viewer.put(frame)
        self._viewers.add(viewer)
        return viewer

    def change(self, viewer: ViewingPage, shows: ViewRequest) -> None:
        """Change the view of a page: it gets the newest frames of the layers that it did not show before."""
        before, viewer.shows = viewer.shows, shows
        for frame in self._frames:
            if key_of(frame)[1] not in before.layers:
                viewer.put(frame)

    def remove(self, viewer: ViewingPage) -> None:
        """Unregister a page that has disconnected."""
        self._viewers.discard(viewer)


async def open_socket(request: web.Request, longest: int, buffer: int = _BUFFER) -> web.WebSocketResponse:
    """Accept the web socket of a page; its messages have at most `longest` bytes, and its send buffer `buffer`."""
    socket = web.WebSocketResponse(
        heartbeat=_HEARTBEAT, autoping=False, compress=False, max_msg_size=longest, timeout=1.0
    )
    await socket.prepare(request)
    limit_buffer(request, buffer)
    return socket


async def receive(socket: web.WebSocketResponse) -> AsyncIterator[WSMessage]:
    """Messages of a page. Pings are answered; more of them, or of pongs, than a browser sends end the connection."""
    bucket = make_bucket(_CONTROL_RATE, _CONTROL_BURST, time.monotonic())
    async for message in socket:
        if message.type not in (WSMsgType.PING, WSMsgType.PONG):
            yield message
            continue
        bucket, allowed = draw(bucket, time.monotonic())
        if not allowed:
            await socket.close(code=WSCloseCode.POLICY_VIOLATION)
            return
        if message.type is WSMsgType.PING:
            await socket.pong(message.data)


def limit_buffer(request: web.Request, size: int = _BUFFER) -> None:
    """Limit the send buffer of a slow page, beyond which only the newest frames are sent."""
    import socket

    transport = request.transport
    if transport is not None:
        transport.set_write_buffer_limits(high=size)
        sock = transport.get_extra_info("socket")
        if sock is not None:
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, "TCP_NOTSENT_LOWAT", 25), size)


class FrameQueue:
    """Frames by key. A grid of another generation drops the tiles of its layer."""

    def __init__(self) -> None:
        self._frames: dict[Key, bytes] = {}

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[bytes]:
        return iter(list(self._frames.values()))

    def put(self, frame: bytes) -> None:
        """Add a frame, in place of the one with the same key. Raises ValueError for an invalid frame."""
        key = key_of(frame)
        if key[0] == Kind.GRID:
            generation = generation_of(frame)
            void = [
                each
                for each, tile in self._frames.items()
                if each[0] == Kind.TILE and each[1] == key[1] and generation_of(tile) != generation
            ]
            for each in void:
                del self._frames[each]
        self._frames[key] = frame

    def pop(self) -> bytes | None:
        """Remove and return the most urgent frame: the lowest kind, the oldest key first; None if empty."""
        if not self._frames:
            return None
        key = min(self._frames, key=lambda each: each[0])
        return self._frames.pop(key)

    def clear(self) -> None:
        """Remove all frames."""
        self._frames.clear()
