"""Pages that show the camera: a separate web socket each, so that pictures never delay map or motion."""

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress

from aiohttp import WSCloseCode, WSMsgType, web

from ur.web.access.rate import draw, make_bucket
from ur.web.server.viewers import receive
from ur.web.wire.layers import is_camera_topic

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
