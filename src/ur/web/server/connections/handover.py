"""Handover of connections to the HTTP server, with the data that was already read from them."""

import asyncio
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import cast

_MOST_READ = 4096  # bytes at once: all requests among them are parsed before another client is served
_MOST_LEFT = 1 << 16  # bytes that a client may send after its only request

Handlers = Callable[[], asyncio.Protocol]
"""Makes the protocol that serves a connection."""


async def serve_all(handlers: Handlers, sock: socket.socket, data: bytes) -> None:
    """Serve a connection whose first bytes are `data`. Returns once the service has begun."""
    with suppress(OSError):
        await asyncio.get_running_loop().connect_accepted_socket(lambda: _Continued(handlers(), data), sock)


async def serve_one(handlers: Handlers, sock: socket.socket, request: bytes, limit: float) -> None:
    """Serve one complete request, for at most `limit` s. Returns when the connection is closed."""
    protocol = _OneRequest(handlers(), request)
    with suppress(OSError):
        await asyncio.get_running_loop().connect_accepted_socket(lambda: protocol, sock)
    with suppress(asyncio.TimeoutError):
        await asyncio.wait_for(protocol.closed.wait(), limit)
    protocol.abort()


class _Continued(asyncio.Protocol):
    """Protocol that passes a connection, and the data already read, to another protocol."""

    def __init__(self, handler: asyncio.Protocol, data: bytes) -> None:
        self._handler, self._data = handler, data

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Pass the connection on."""
        transport.max_size = _MOST_READ  # type: ignore[attr-defined]  # of asyncio's transports of sockets
        transport.set_protocol(self._handler)
        self._handler.connection_made(transport)
        self._handler.data_received(self._data)


class _OneRequest(asyncio.Protocol):
    """Protocol that passes a single request to another protocol, and drops all later data."""

    def __init__(self, handler: asyncio.Protocol, request: bytes) -> None:
        self._handler, self._request = handler, request
        self._transport: asyncio.Transport | None = None
        self._left = _MOST_LEFT
        self.closed = asyncio.Event()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Pass the request on."""
        self._transport = cast("asyncio.Transport", transport)
        self._handler.connection_made(transport)
        self._handler.data_received(self._request)

    def data_received(self, data: bytes) -> None:
        """Drop the data, and close the connection if there is much of it."""
        self._left -= len(data)
        if self._left < 0:
            self.abort()

    def eof_received(self) -> bool:
        """Keep the connection open for the response."""
        return True

    def pause_writing(self) -> None:
        """Forward the call."""
        self._handler.pause_writing()

    def resume_writing(self) -> None:
        """Forward the call."""
        self._handler.resume_writing()

    def connection_lost(self, problem: Exception | None) -> None:
        """Forward the call."""
        self.closed.set()
        self._handler.connection_lost(problem)

    def abort(self) -> None:
        """Close the connection at once."""
        if self._transport is not None:
            self._transport.abort()
