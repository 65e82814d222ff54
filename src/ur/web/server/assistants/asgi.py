"""Requests of aiohttp, answered by an application of the other interface for web servers in Python, ASGI."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from aiohttp import web

from ur.web.server.logins.gate import HEADERS

Message = MutableMapping[str, Any]
AsgiApplication = Callable[
    [Message, Callable[[], Awaitable[Message]], Callable[[Message], Awaitable[None]]], Awaitable[None]
]

_LOOK_EVERY = 0.05  # s between two looks at whether the client has disconnected


async def answer(request: web.Request, application: AsgiApplication, longest: int) -> web.StreamResponse:
    """Have an application answer a request whose body has at most `longest` bytes. Raises HTTPRequestEntityTooLarge."""
    exchange = _Exchange(request, await _read_body(request, longest))
    await application(exchange.scope(), exchange.receive, exchange.send)
    if exchange.response is None:
        raise web.HTTPInternalServerError(text="the application has not answered\n")
    return exchange.response


async def _read_body(request: web.Request, longest: int) -> bytes:
    body = bytearray()
    async for part in request.content.iter_any():
        body += part
        if len(body) > longest:
            raise web.HTTPRequestEntityTooLarge(max_size=longest, actual_size=len(body), text="too long\n")
    return bytes(body)


class _Exchange:
    """One request and its response."""

    def __init__(self, request: web.Request, body: bytes) -> None:
        self._request = request
        self._body: bytes | None = body
        self.response: web.StreamResponse | None = None

    def scope(self) -> Message:
        """The request line and the headers."""
        request = self._request
        return {
            "type": "http",
            "asgi": {"version": "3.0"},
            "http_version": "1.1",
            "method": request.method,
            "scheme": "http",
            "path": request.path,
            "raw_path": request.path.encode(),
            "query_string": request.query_string.encode(),
            "root_path": "",
            "headers": [(name.lower(), value) for name, value in request.raw_headers],
            "client": (request.remote or "", 0),
            "server": None,
        }

    async def receive(self) -> Message:
        """Return the body, then wait until the client has disconnected."""
        if self._body is not None:
            body, self._body = self._body, None
            return {"type": "http.request", "body": body, "more_body": False}
        while (transport := self._request.transport) is not None and not transport.is_closing():
            await asyncio.sleep(_LOOK_EVERY)
        return {"type": "http.disconnect"}

    async def send(self, message: Message) -> None:
        """Send the head of the response, or a part of its body. Raises OSError if the client has disconnected."""
        if message["type"] == "http.response.start":
            self.response = response = web.StreamResponse(status=message["status"])
            for name, value in message.get("headers", ()):
                if name.lower() not in (b"content-length", b"transfer-encoding", b"connection"):
                    response.headers.add(name.decode("latin-1"), value.decode("latin-1"))
            response.headers.update({**HEADERS, "Cache-Control": "no-store"})
            await response.prepare(self._request)
        elif message["type"] == "http.response.body" and self.response is not None:
            await self.response.write(message.get("body", b""))
            if not message.get("more_body"):
                await self.response.write_eof()
