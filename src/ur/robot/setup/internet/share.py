"""Package servers for commands on a robot: reached directly, or by a proxy of this computer over ssh."""

import asyncio
import base64
import hmac
import importlib
import ipaddress
import re
import secrets
import socket
import threading
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from urllib.parse import urlsplit

from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, quote

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


PROBE_SECONDS = 4
# A line for each: `apt URL`, `pip URL`, `index` if pip has a configured index, `proxy` if there is one.
SCRIPT = """\
apt-get indextargets --format 'apt $(REPO_URI)' 2>/dev/null | sort -u
apt-config dump 2>/dev/null | grep -qiE '^Acquire::(http|https)::Proxy(::[^ ]+)? "[^"]' && echo proxy
set -- /etc/pip.conf /etc/xdg/pip/pip.conf "$HOME/.pip/pip.conf" "$HOME/.config/pip/pip.conf"
cat "$@" 2>/dev/null | grep -qE '^[[:space:]]*proxy[[:space:]]*[=:]' && echo proxy
cat "$@" 2>/dev/null | grep -qE '^[[:space:]]*index[-_]url[[:space:]]*[=:]' && echo index
cat "$@" 2>/dev/null | grep -v '^[[:space:]]*[#;]' | grep -oE 'https?://[^"[:space:]]+' | sed 's/^/pip /'
echo end"""

Route = Callable[[], Secret]


@contextmanager
def share_internet(shell: SshShell, report: Callable[[str], None]) -> Iterator[Route]:
    """Yield a function that returns the standard input of commands that download packages: a proxy and its exceptions.

    Both lines are empty if the robot reaches its package servers, or if this computer does not reach them either.
    Servers are tested only when the function is called, and the proxy ends with the context.
    """
    found: list[Secret] = []
    with ExitStack() as stack:

        def route() -> Secret:
            if not found:
                found.append(_find_route(shell, stack, report))
            return found[0]

        yield route


def _find_route(shell: SshShell, stack: ExitStack, report: Callable[[str], None]) -> Secret:
    direct = Secret("\n\n")
    servers = parse_servers(shell.run(SCRIPT).out, default_index_servers())
    unreached = sorted(find_unreached(shell, servers)) if servers else []
    if not unreached:
        return direct
    with ThreadPoolExecutor(len(unreached)) as pool:
        shared = [server for server, good in zip(unreached, pool.map(reaches, unreached), strict=True) if good]
    if not shared:
        return direct
    password = Secret(secrets.token_hex(16))
    port = stack.enter_context(run_proxy(shared, password))
    there = shell.forward_back(port)
    if not there:
        report("it has no internet, and its ssh server does not allow forwarding (AllowTcpForwarding)")
        return direct
    names = ", ".join(sorted({server.host for server in shared}))
    report(f"it has no internet: it fetches packages over this computer's connection ({names})")
    reached = ",".join(sorted({server.host for server in servers} - {server.host for server in shared}))
    return Secret(f"http://{USER}:{password.reveal()}@127.0.0.1:{there}\n{reached}\n")


def parse_servers(text: str, default_index: Iterable[Server]) -> frozenset[Server]:
    """Parse the output of SCRIPT. `default_index` are the servers of pip without a configured index."""
    lines = text.splitlines()
    if "proxy" in lines:
        return frozenset()
    found = {parse_server(line.partition(" ")[2]) for line in lines if line.startswith(("apt ", "pip "))}
    if "index" not in lines:
        found |= set(default_index)
    return frozenset(server for server in found if server is not None)


def default_index_servers() -> frozenset[Server]:
    """Return the servers of pip's default index, as the pip of this environment names them."""
    try:
        index = importlib.import_module("pip._internal.models.index").PyPI
        hosts = (str(index.netloc), str(index.file_storage_domain))
    except (ImportError, AttributeError):
        return frozenset()
    return frozenset(server for host in hosts if (server := parse_server(f"https://{host}/")))


def find_unreached(shell: Shell, servers: Iterable[Server]) -> frozenset[Server]:
    """Return the servers that the robot cannot reach."""
    asked = {f"{server.host}:{server.port}": server for server in servers}
    probes = "".join(
        f"(timeout {PROBE_SECONDS} bash -c {quote(f'exec 3<>/dev/tcp/{each.host}/{each.port}')} 2>/dev/null || "
        f"echo {quote(f'no {name}')}) & "
        for name, each in sorted(asked.items())
    )
    reported = shell.run(f"{probes} wait", timeout=60.0).out
    return frozenset(asked[name] for name in re.findall(r"(?m)^no (\S+)$", reported) if name in asked)


def reaches(server: Server) -> bool:
    """Return whether a server answers this computer."""
    for address in find_addresses(server):
        try:
            socket.create_connection((address, server.port), timeout=PROBE_SECONDS).close()
        except OSError:
            continue
        return True
    return False
