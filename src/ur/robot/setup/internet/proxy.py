"""An HTTP proxy on the loopback interface that forwards to a fixed list of servers, as long as its context lasts.

apt sends GET requests with absolute URLs, or CONNECT for https; pip sends CONNECT. Both send a password that is
generated for one set-up. Their downloads are signed (apt) or pinned by hashes (pip), so the proxy checks no content.
"""

import asyncio
import base64
import hmac
import ipaddress
import re
import socket
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from urllib.parse import urlsplit

from ur.robot.ssh.secret import Secret

USER = "ubiquity"
HEAD_BYTES = 16384
CONNECTIONS = 32
HEAD_SECONDS = 20.0
CONNECT_SECONDS = 10.0
IDLE_SECONDS = 60.0
PIECE = 65536
_PORTS = {"http": 80, "https": 443}
_HOST = re.compile(r"[A-Za-z0-9]([A-Za-z0-9.-]{0,252}[A-Za-z0-9])?")
_HOP_BY_HOP = ("connection:", "proxy-", "keep-alive:", "te:", "upgrade:")


@dataclass(frozen=True, slots=True, order=True)
class Server:
    """A permitted server: a host name in lower case, and a port."""

    host: str
    port: int


@dataclass(frozen=True, slots=True)
class Forward:
    """A permitted request. `head` is sent to the server; it is empty for a tunnel (CONNECT)."""

    server: Server
    head: bytes


@dataclass(frozen=True, slots=True)
class Refusal:
    """A refused request, and the response to it."""

    status: str

    @property
    def answer(self) -> bytes:
        """The bytes of the response."""
        return f"HTTP/1.1 {self.status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n".encode()


def parse_server(url: str) -> Server | None:
    """Parse the server of an http or https URL; None for any other text."""
    try:
        parts = urlsplit(url.strip())
        host, port = (parts.hostname or "").lower(), parts.port or _PORTS.get(parts.scheme, 0)
    except ValueError:
        return None
    return Server(host, port) if parts.scheme in _PORTS and port and _HOST.fullmatch(host) else None


def read_request(head: bytes, servers: Collection[Server], password: Secret) -> Forward | Refusal:
    """Decide on a request by its header, up to the empty line."""
    first, *fields = head.decode("latin-1").split("\r\n")
    words = first.split(" ")
    if len(words) != 3 or not words[2].startswith("HTTP/1."):
        return Refusal("400 Bad Request")
    if not _is_authorized(fields, password):
        return Refusal("407 Proxy Authentication Required")
    method, target, _ = words
    server = parse_server(f"https://{target}" if method == "CONNECT" else target)
    if server is None or method not in ("CONNECT", "GET", "HEAD"):
        return Refusal("405 Method Not Allowed")
    if server not in servers:
        return Refusal("403 Forbidden")
    if method == "CONNECT":
        return Forward(server, b"")
    parts = urlsplit(target)
    path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
    kept = [field for field in fields if field and not field.lower().startswith(_HOP_BY_HOP)]
    lines = [f"{method} {path} HTTP/1.1", *kept, "Connection: close", "", ""]
    return Forward(server, "\r\n".join(lines).encode("latin-1"))


def _is_authorized(fields: Collection[str], password: Secret) -> bool:
    expected = base64.b64encode(f"{USER}:{password.reveal()}".encode())
    for field in fields:
        name, _, value = field.partition(":")
        kind, _, given = value.strip().partition(" ")
        if name.lower() == "proxy-authorization" and kind.lower() == "basic":
            return hmac.compare_digest(given.strip().encode("latin-1"), expected)
    return False


def is_forbidden(address: str) -> bool:
    """Return whether an address is this computer's or a special one, to which the proxy must not connect a robot."""
    found = ipaddress.ip_address(address.partition("%")[0])
    plain = getattr(found, "ipv4_mapped", None) or found
    return bool(plain.is_loopback or plain.is_link_local or plain.is_multicast or plain.is_unspecified)


def find_addresses(server: Server) -> list[str]:
    """Return the permitted addresses of a server; empty if its name cannot be resolved."""
    try:
        found = socket.getaddrinfo(server.host, server.port, type=socket.SOCK_STREAM)
    except OSError:
        return []
    addresses = dict.fromkeys(str(each[4][0]) for each in found)
    return [address for address in addresses if not is_forbidden(address)]


@contextmanager
def run_proxy(
    servers: Collection[Server], password: Secret, find: Callable[[Server], list[str]] = find_addresses
) -> Iterator[int]:
    """Forward requests to these servers while the context lasts; yield the port on 127.0.0.1.

    `find` returns the addresses of a server.
    """
    loop = asyncio.new_event_loop()
    tasks: set[asyncio.Task[None]] = set()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task
        if len(tasks) >= CONNECTIONS:
            writer.close()
            return
        tasks.add(task)
        try:
            await _serve(reader, writer, servers, password, find)
        except (OSError, TimeoutError, asyncio.TimeoutError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            pass  # the client detects the end of the connection
        finally:
            tasks.discard(task)
            writer.close()

    async def stop() -> None:
        server.close()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    server = loop.run_until_complete(asyncio.start_server(serve, "127.0.0.1", 0, limit=HEAD_BYTES))
    thread = threading.Thread(target=loop.run_forever, name="proxy", daemon=True)
    thread.start()
    try:
        yield int(server.sockets[0].getsockname()[1])
    finally:
        asyncio.run_coroutine_threadsafe(stop(), loop).result(IDLE_SECONDS)
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()


async def _serve(
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
    servers: Collection[Server],
    password: Secret,
    find: Callable[[Server], list[str]],
) -> None:
    head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), HEAD_SECONDS)
    request = read_request(head, servers, password)
    if isinstance(request, Refusal):
        await _answer(reader, writer, request)
        return
    for address in await asyncio.to_thread(find, request.server):
        try:
            there = await asyncio.wait_for(asyncio.open_connection(address, request.server.port), CONNECT_SECONDS)
            break
        except (OSError, asyncio.TimeoutError):
            continue
    else:
        await _answer(reader, writer, Refusal("502 Bad Gateway"))
        return
    try:
        if request.head:
            there[1].write(request.head)
            await _copy(there[0], writer)
            await _finish(reader, writer)
        else:
            writer.write(b"HTTP/1.1 200 Connection established\r\n\r\n")
            await asyncio.gather(_copy(there[0], writer), _copy(reader, there[1]))
    finally:
        there[1].close()


async def _answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, refusal: Refusal) -> None:
    writer.write(refusal.answer)
    await writer.drain()
    await _finish(reader, writer)


async def _copy(source: asyncio.StreamReader, target: asyncio.StreamWriter) -> None:
    """Copy data until the source ends, and pass the end on."""
    while piece := await asyncio.wait_for(source.read(PIECE), IDLE_SECONDS):
        target.write(piece)
        await asyncio.wait_for(target.drain(), IDLE_SECONDS)
    with suppress(OSError):
        target.write_eof()


async def _finish(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Close a connection so that the client receives the whole response: unread input would reset it."""
    with suppress(OSError, asyncio.TimeoutError):
        if writer.can_write_eof():
            writer.write_eof()
        while await asyncio.wait_for(reader.read(PIECE), CONNECT_SECONDS):
            pass
