"""Listener that accepts and classifies connections before the HTTP server gets them.

A connection waits here until the head of its first request is complete. One whose head contains the secret of a session
is handed over at once and without limits. All others are limited in number, rate, size of head and body, and time; and
each of them serves one request. Large heads have lower rates, which are drawn from before a secret is looked for. If
there are too many connections, the oldest ones of the address with the most are dropped: so a new connection of a
session is always accepted, and has time until hundreds of others have arrived from its address.
"""

import asyncio
import errno
import os
import socket
from collections.abc import Callable, Coroutine, Sequence
from contextlib import suppress
from itertools import takewhile
from typing import cast

from ur.web.access.origin import LONGEST, Head, find_head
from ur.web.access.rate import Buckets, SharedBuckets, make_bucket

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


HEAD_LIMIT = 10.0
"""Seconds for the head of a request, and for the rest of a connection without a session."""

LONGEST_BODY = 2048
"""Bytes of the longest body of a request without a session."""

MOST_WAITING = 512  # connections whose first head is not complete
_MOST_SERVED = 32  # connections without a session whose request the HTTP server is processing
_MOST_CLOSING, _CLOSE_LIMIT = 64, 1.0  # s for which a refused connection may still send
_MOST_READS = 64  # pieces of a head
_AT_ONCE = 8  # connections accepted in one go before others are served
_BACKLOG = 1024
_RATES, _RATES_OF_ALL = (50.0, 200.0), (100.0, 400.0)  # of an address, of all: requests a second, at once
_LARGE = 8192  # bytes of a head that is read only at these rates
_LARGE_RATES, _LARGE_RATES_OF_ALL = (5.0, 10.0), (20.0, 40.0)
_SWEEP_EVERY = 1.0  # s
_RETRY = 0.2  # s after an accept has failed
_NO_ROOM = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class _Waiting:
    """A connection whose first request is incomplete."""

    __slots__ = ("address", "buffer", "head", "reads", "sock", "until")

    def __init__(self, sock: socket.socket, address: str, until: float) -> None:
        self.sock, self.address, self.until = sock, address, until
        self.buffer, self.reads = bytearray(), 0
        self.head: Head | None = None

    @property
    def is_read(self) -> bool:
        """Return whether the whole request has been read."""
        head = self.head
        return head is not None and head.body is not None and len(self.buffer) == len(head.data) + head.body


class ConnectionListener:
    """Accepts connections and has `handlers` make the protocol that serves each.

    `recognise` returns whether a head contains the secret of a session; it must be fast. `answer` returns the bytes of
    a refusal from a status and a text. `log` is called with a line.
    """

    def __init__(
        self,
        handlers: Handlers,
        recognise: Callable[[Head], bool],
        answer: Callable[[int, str], bytes],
        log: Callable[[str], None],
        *,
        head_limit: float = HEAD_LIMIT,
        most_waiting: int = MOST_WAITING,
    ) -> None:
        self._head_limit, self._most_waiting = head_limit, most_waiting
        self._handlers, self._recognise, self._answer, self._log = handlers, recognise, answer, log
        self._loop = asyncio.get_running_loop()
        self._listening: list[socket.socket] = []
        self._waiting: dict[str, dict[socket.socket, _Waiting]] = {}  # by address, oldest first
        self._count = 0
        self._closing: dict[socket.socket, float] = {}
        self._served: set[object] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        now = self._loop.time()
        self._rates = SharedBuckets(Buckets(*_RATES), make_bucket(*_RATES_OF_ALL, now))
        self._large = SharedBuckets(Buckets(*_LARGE_RATES), make_bucket(*_LARGE_RATES_OF_ALL, now))
        self._sweeping: asyncio.TimerHandle | None = None

    def open(self, listening: Sequence[socket.socket]) -> None:
        """Accept connections of these sockets, see `listen`, and close them at the end."""
        self._listening = list(listening)
        for sock in self._listening:
            self._loop.add_reader(sock, self._accept, sock)
        self._sweep()

    def close(self) -> None:
        """Stop listening, and drop waiting connections. Requests in progress continue."""
        for sock in self._listening:
            self._loop.remove_reader(sock)
            sock.close()
        self._listening.clear()
        if self._sweeping is not None:
            self._sweeping.cancel()
        for waiting in [each for group in self._waiting.values() for each in group.values()]:
            self._drop(waiting)
        for sock in list(self._closing):
            self._end(sock)

    def __len__(self) -> int:
        """Return the number of connections without a session."""
        return self._count + len(self._closing) + len(self._served)

    def _accept(self, listening: socket.socket) -> None:
        for _ in range(_AT_ONCE):
            try:
                sock, address = listening.accept()
            except (BlockingIOError, InterruptedError):
                return
            except OSError as problem:
                if problem.errno in _NO_ROOM:
                    self._make_room(listening, problem)
                    return
                continue  # this one has closed
            sock.setblocking(False)
            waiting = _Waiting(sock, str(address[0]), self._loop.time() + self._head_limit)
            self._count += 1
            self._waiting.setdefault(waiting.address, {})[sock] = waiting
            self._read(waiting)  # the head has usually arrived: no reader is needed
            if sock in self._waiting.get(waiting.address, ()):
                self._loop.add_reader(sock, self._read, waiting)
            if self._count > self._most_waiting:
                self._drop(next(iter(max(self._waiting.values(), key=len).values())))

    def _make_room(self, listening: socket.socket, problem: OSError) -> None:
        """Drop all waiting connections, and accept new ones a moment later."""
        for waiting in [each for group in self._waiting.values() for each in group.values()]:
            self._drop(waiting)
        self._log(f"connections cannot be accepted: {(problem.strerror or str(problem)).lower()}")
        self._loop.remove_reader(listening)

        def go_on() -> None:
            if listening in self._listening:
                self._loop.add_reader(listening, self._accept, listening)

        self._loop.call_later(_RETRY, go_on)

    def _read(self, waiting: _Waiting) -> None:
        """Read available data; continue once the head, or the request of a client without a session, is complete."""
        try:
            data = waiting.sock.recv(LONGEST)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            data = b""
        waiting.reads += 1
        before = len(waiting.buffer)
        waiting.buffer += data
        if not data or waiting.reads > _MOST_READS:
            self._drop(waiting)
            return
        if waiting.head is not None:
            self._complete(waiting, waiting.head)
            return
        head = find_head(waiting.buffer, before)
        size = len(waiting.buffer) if head is None else len(head.data)
        if size > LONGEST or (before <= _LARGE < size and not self._large.allows(waiting.address, self._loop.time())):
            self._drop(waiting)
        elif head is not None:
            waiting.head = head
            self._judge(waiting, head)

    def _judge(self, waiting: _Waiting, head: Head) -> None:
        """Decide on a connection by the head of its first request."""
        if self._recognise(head):
            self._forget(waiting)
            self._start(serve_all(self._handlers, waiting.sock, bytes(waiting.buffer)))
            return
        if not self._rates.allows(waiting.address, self._loop.time()):
            self._refuse(waiting, 429, "too many requests\n")
        elif head.body is None or head.body > LONGEST_BODY:
            self._refuse(waiting, 413, f"expected at most {LONGEST_BODY} bytes\n")
        else:
            self._complete(waiting, head)

    def _complete(self, waiting: _Waiting, head: Head) -> None:
        """Hand over a single request when its body is complete."""
        size = len(head.data) + (head.body or 0)
        if len(waiting.buffer) < size:
            return
        if len(self._served) >= _MOST_SERVED:
            self._refuse(waiting, 503, "too many connections, try again\n")
            return
        self._forget(waiting)
        self._start(self._serve_once(waiting.sock, bytes(waiting.buffer[:size])))

    async def _serve_once(self, sock: socket.socket, request: bytes) -> None:
        key = object()
        self._served.add(key)
        try:
            await serve_one(self._handlers, sock, request, self._head_limit)
        finally:
            self._served.discard(key)

    def _start(self, serving: Coroutine[None, None, None]) -> None:
        task = self._loop.create_task(serving)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _refuse(self, waiting: _Waiting, status: int, text: str) -> None:
        """Send a refusal, and read for a moment: closing a socket with unread data would discard the refusal."""
        self._forget(waiting)
        sock = waiting.sock
        with suppress(OSError):
            sock.send(self._answer(status, text))
        if waiting.is_read:
            sock.close()
            return
        try:
            sock.shutdown(socket.SHUT_WR)
        except OSError:
            sock.close()
            return
        self._closing[sock] = self._loop.time() + _CLOSE_LIMIT
        self._loop.add_reader(sock, self._discard, sock)
        if len(self._closing) > _MOST_CLOSING:
            self._end(next(iter(self._closing)))

    def _discard(self, sock: socket.socket) -> None:
        with suppress(BlockingIOError, InterruptedError):
            try:
                data = sock.recv(LONGEST)
            except ConnectionError:
                data = b""
            if not data:
                self._end(sock)

    def _end(self, sock: socket.socket) -> None:
        del self._closing[sock]
        self._loop.remove_reader(sock)
        sock.close()

    def _forget(self, waiting: _Waiting) -> None:
        """Remove a connection from the waiting ones. Its socket stays open."""
        self._loop.remove_reader(waiting.sock)
        group = self._waiting[waiting.address]
        del group[waiting.sock]
        if not group:
            del self._waiting[waiting.address]
        self._count -= 1

    def _drop(self, waiting: _Waiting) -> None:
        self._forget(waiting)
        waiting.sock.close()

    def _sweep(self) -> None:
        """Periodically close connections that exceed their time limit."""
        now = self._loop.time()
        late = [
            each for group in self._waiting.values() for each in takewhile(lambda one: one.until < now, group.values())
        ]
        for waiting in late:
            self._drop(waiting)
        for sock in [sock for sock, until in self._closing.items() if until < now]:
            self._end(sock)
        self._sweeping = self._loop.call_later(_SWEEP_EVERY, self._sweep)


def listen(host: str, port: int) -> list[socket.socket]:
    """Listen on all addresses of a host name that this computer has. Raises OSError."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    opened: list[socket.socket] = []
    try:
        for family, kind, protocol, _, address in dict.fromkeys(found):
            sock = _listen(family, kind, protocol, address)
            if sock is not None:
                opened.append(sock)
        if not opened:
            raise OSError(errno.EADDRNOTAVAIL, os.strerror(errno.EADDRNOTAVAIL))
    except OSError:
        for sock in opened:
            sock.close()
        raise
    return opened


def _listen(family: int, kind: int, protocol: int, address: tuple[str | int | bytes, ...]) -> socket.socket | None:
    """Listen on an address; None if this computer does not have it. Raises OSError."""
    try:
        sock = socket.socket(family, kind, protocol)
    except OSError:  # no IPv6
        return None
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        sock.setblocking(False)
        sock.bind(address)
        sock.listen(_BACKLOG)
    except OSError as problem:
        sock.close()
        if problem.errno == errno.EADDRNOTAVAIL:
            return None
        raise
    return sock
