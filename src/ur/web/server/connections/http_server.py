"""The HTTP server behind the listener, and the log of its errors."""

import asyncio
import logging
import socket
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from functools import cache
from http import HTTPStatus
from typing import Any

from aiohttp import web

from ur.web.server.connections.listener import ConnectionListener
from ur.web.server.logins.gate import HEADERS, LoginGate

_END_LIMIT = 3.0  # s
_KEEP_ALIVE = 300.0  # s: as long as browsers keep an idle connection
_LOGGED_EVERY = 60.0  # s


@asynccontextmanager
async def open_server(
    application: web.Application,
    gate: LoginGate,
    listening: Sequence[socket.socket],
    log: Callable[[str], None],
    **bounds: Any,
) -> AsyncIterator[ConnectionListener]:
    """Serve an application on sockets, see `listen`, while the context lasts; they are closed at its end.

    `log` is called at most once a minute about failed connections. `bounds` are those of ConnectionListener.
    """
    rarely = Rarely(log)
    logging.getLogger("aiohttp").addHandler(logging.NullHandler())
    logging.getLogger("aiohttp").propagate = False
    loop = asyncio.get_running_loop()
    before = loop.get_exception_handler()
    loop.set_exception_handler(rarely.report)
    runner = web.AppRunner(
        application,
        access_log=None,
        handle_signals=False,
        # Bodies are not decompressed, and data after a refusal is not read: both would delay all other requests.
        auto_decompress=False,
        lingering_time=0.0,
        keepalive_timeout=_KEEP_ALIVE,
        shutdown_timeout=_END_LIMIT,
    )
    await runner.setup()
    assert runner.server is not None, "set up"
    listener = ConnectionListener(runner.server, gate.recognise, _answer, rarely, **bounds)
    try:
        listener.open(listening)
        yield listener
    finally:
        listener.close()
        await runner.cleanup()
        loop.set_exception_handler(before)


class Rarely:
    """A log of at most one line per minute, which includes the number of omitted lines."""

    def __init__(self, log: Callable[[str], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._log, self._next, self._left_out = log, 0.0, 0

    def __call__(self, line: str) -> None:
        """Log a line, or count it as omitted."""
        now = self._clock()
        if now < self._next:
            self._left_out += 1
            return
        more = f" ({self._left_out} more were left out before)" if self._left_out else ""
        self._next, self._left_out = now + _LOGGED_EVERY, 0
        self._log(line + more)

    def report(self, _loop: asyncio.AbstractEventLoop, context: Mapping[str, object]) -> None:
        """Log an error of the event loop."""
        self(f"{context.get('message')}: {context.get('exception')!r}")


@cache
def _answer(status: int, text: str) -> bytes:
    """Return a response that refuses a connection before its request is read."""
    headers = {**HEADERS, "Cache-Control": "no-store", "Connection": "close", "Content-Type": "text/plain"}
    lines = [f"HTTP/1.1 {status} {HTTPStatus(status).phrase}", *(f"{name}: {value}" for name, value in headers.items())]
    return ("\r\n".join([*lines, f"Content-Length: {len(text)}", "", ""]) + text).encode("ascii")
