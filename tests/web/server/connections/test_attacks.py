"""Clients without a login that try to silence the page: a session is served, and what they take is bounded.

`bench/web_attack` measures the delays.
"""

import asyncio
import contextlib
import json
import zlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServer  # noqa: E402
from tests.web.server.robot_processes import IdleRobotEnd, keep  # noqa: E402

from ur.web.access.origin import Head, make_origins  # noqa: E402
from ur.web.access.rate import Buckets  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import Rarely, open_server  # noqa: E402
from ur.web.server.connections.listener import ConnectionListener, listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.static_files import load_files  # noqa: E402

DRIVE = "/ws/drive?tab=0123456789ab"
PACKED = (lambda packer: packer.compress(bytes(1 << 26)) + packer.flush())(zlib.compressobj(9, wbits=31))


@dataclass
class AttackedServer(PageServer):
    listener: ConnectionListener
    port: int
    log: list[str]
    stopped: list[Any]

    async def stop(self, client: Any) -> None:
        """Press STOP, over the connection that is open and over another one."""
        before = len(self.stopped)
        for headers in ({}, {"Connection": "close"}):
            async with client.post(f"{self.url}/api/stop", headers=headers) as answer:
                assert answer.status == 200
        assert self.stopped[before:] == [{"do": "stop"}] * 2

    async def open(self, data: bytes = b"") -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        writer.write(data)
        return reader, writer

    async def answer(self, data: bytes) -> bytes:
        """All that the server sends until it closes the connection."""
        reader, writer = await self.open(data)
        with contextlib.suppress(ConnectionError):
            return await asyncio.wait_for(reader.read(), 60.0)
        writer.close()
        return b""

    def request(self, line: str = "GET /main.js", body: bytes = b"", *headers: str) -> bytes:
        lines = [f"{line} HTTP/1.1", f"Host: 127.0.0.1:{self.port}", f"Origin: {self.url}", *headers]
        return "\r\n".join([*lines, f"Content-Length: {len(body)}", "", ""]).encode() + body


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[AttackedServer]:
    async with serve(tmp_path) as server:
        yield server


@asynccontextmanager
async def serve(folder: Path, **bounds: float) -> AsyncIterator[AttackedServer]:
    port, log, ends = free_port(), list[str](), list[IdleRobotEnd]()
    gate = LoginGate(make_origins((), port), folder / "sessions.json", log.append)
    application = Application(gate, load_files(), {}, "bob", log.append, make_robot_process=keep(ends, IdleRobotEnd))
    async with open_server(application.build(), gate, listen("127.0.0.1", port), log.append, **bounds) as listener:
        yield AttackedServer(gate, f"http://127.0.0.1:{port}", listener, port, log, ends[0].passed)


@pytest.mark.parametrize("data", [b"", b"GET /login HTTP/1.1\r\nHost: loc"])
async def test_connections_that_wait_for_nothing_are_bounded_and_a_session_finds_room(
    tmp_path: Path, data: bytes
) -> None:
    async with serve(tmp_path, most_waiting=64) as server:
        await fill_with_connections(server, data)


async def fill_with_connections(server: AttackedServer, data: bytes) -> None:
    client = await server.open_client()
    idle = [await server.open(data) for _ in range(300)]
    async with client, client.ws_connect(server.url + DRIVE) as drive:
        assert (await drive.receive_json(timeout=30))["t"] == "hello"
        server.stopped.clear()
        await server.stop(client)
        assert len(server.listener) <= 64
        assert not drive.closed
        assert (await client.get(f"{server.url}/main.js")).status == 200
    for _, writer in idle:
        writer.close()


async def test_session_whose_head_is_late_is_served_beside_hundreds_of_others(server: AttackedServer) -> None:
    async with await server.open_client() as client:
        (cookie,) = client.cookie_jar
        reader, writer = await server.open()  # and the client is held up
        others = [await server.open() for _ in range(400)]
        writer.write(server.request("POST /api/stop", b"", f"Cookie: {cookie.key}={cookie.value}", "Connection: close"))
        assert (await asyncio.wait_for(reader.read(), 60.0))[9:12] == b"200"
    for _, each in [(reader, writer), *others]:
        each.close()


async def test_head_that_does_not_end_in_time_ends_the_connection(server: AttackedServer, tmp_path: Path) -> None:
    async with serve(tmp_path / "hasty", head_limit=0.0) as hasty:
        assert await hasty.answer(b"GET /login HTTP/1.1\r\nX: ") == b""
    assert await server.answer(b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 10_000) == b""
    _, writer = await server.open()
    with contextlib.suppress(ConnectionError):
        for _ in range(1000):  # a byte at a time
            writer.write(b"G")
            await writer.drain()
            await asyncio.sleep(0)
    assert len(server.listener) <= 1
    writer.close()


async def test_requests_without_a_login_are_limited_and_never_those_of_a_session(server: AttackedServer) -> None:
    client, other = await server.open_client(), await server.open_client(Role.LOOK)
    async with client, other, client.ws_connect(server.url + DRIVE) as drive:
        server.listener._rates.of_each = Buckets(0.0, 50.0)
        codes = {(await server.answer(server.request()))[9:12] for _ in range(60)}
        assert codes == {b"403", b"429"}
        assert (await drive.receive_json(timeout=30))["t"] == "hello"
        server.stopped.clear()
        await server.stop(client)
        await server.stop(other)
        async with client.ws_connect(server.url + DRIVE.replace("9ab", "9ac")) as again:
            assert (await again.receive_json(timeout=30))["t"] == "hello"
        assert not drive.closed
    assert len(server.log) < 50


async def test_large_heads_without_a_login_are_few_and_a_session_is_served(server: AttackedServer) -> None:
    recognised = list[Head]()
    recognise = server.listener._recognise

    def note(head: Head) -> bool:
        recognised.append(head)
        return recognise(head)

    server.listener._recognise = note
    server.listener._large.of_each = Buckets(0.0, 10.0)
    near = "; ".join([f"ur_web_{server.port}={129 * 'a'}"] * 220)
    answers = [await server.answer(server.request("GET /login", b"", f"Cookie: {near}")) for _ in range(30)]
    assert [bool(each) for each in answers] == [True] * 10 + [False] * 20
    assert len(recognised) == 10
    async with await server.open_client() as client:
        server.stopped.clear()
        await server.stop(client)


async def test_session_that_asks_too_much_limits_itself_only_and_can_stop(server: AttackedServer) -> None:
    busy, client = await server.open_client(), await server.open_client(Role.LOOK)
    async with busy, client:
        server.gate._requests = Buckets(0.0, 50.0)
        codes = [(await busy.get(f"{server.url}/api/me")).status for _ in range(60)]
        assert set(codes) == {200, 429}
        assert (await client.get(f"{server.url}/api/me")).status == 200
        await server.stop(busy)
        await server.stop(client)


async def test_session_that_sends_requests_without_waiting_is_disconnected_and_fills_no_log(
    server: AttackedServer,
) -> None:
    async with await server.open_client(Role.LOOK) as busy, await server.open_client() as client:
        (cookie,) = (f"Cookie: {each.key}={each.value}" for each in busy.cookie_jar)
        many = b"".join(server.request(line, b"", cookie) for line in ("POST /api/stop", "GET /nope")) * 1000
        for _ in range(4):
            assert (await server.answer(many)).count(b"HTTP/1.1 ") <= 32
        few = server.request("GET /api/me", b"", cookie) * 2 + server.request("GET /", b"", cookie, "Connection: close")
        assert (await server.answer(few)).count(b"HTTP/1.1 200") == 3
        await server.stop(client)
        async with busy.post(f"{server.url}/api/stop") as answer:
            assert answer.status == 200
        for _ in range(30):
            await server.stop(busy)
        assert len([line for line in server.log if "emergency stop" in line]) <= 30


async def test_page_can_be_loaded_again_and_again_at_once(server: AttackedServer) -> None:
    async with await server.open_client(Role.LOOK) as client:
        for _ in range(8):
            for name in load_files():
                assert (await client.get(f"{server.url}/{name}")).status == 200


async def test_connection_without_a_login_is_good_for_one_request(server: AttackedServer) -> None:
    answer = await server.answer(server.request("GET /login") * 3)
    assert answer.count(b"HTTP/1.1 200") == 1
    assert b"connection: close" in answer.lower()


async def test_wrong_logins_do_not_keep_a_good_link_out(server: AttackedServer) -> None:
    token = server.gate.invite(Role.LOOK)
    wrong, good = json.dumps({"token": "x" * 24}).encode(), json.dumps({"token": token}).encode()
    codes = [(await server.answer(server.request("POST /login", wrong)))[9:12] for _ in range(20)]
    assert codes[-1] == b"429"
    assert (await server.answer(server.request("POST /login", good)))[9:12] == b"200"
    assert len([line for line in server.log if "refused" in line]) <= 11


@pytest.mark.parametrize("encoding", ["gzip", "deflate"])
async def test_packed_bodies_are_refused_and_not_unpacked(server: AttackedServer, encoding: str) -> None:
    assert len(PACKED) > 2048
    packed = server.request("POST /login", PACKED, f"Content-Encoding: {encoding}")
    assert (await server.answer(packed))[9:12] in (b"413", b"")
    small = zlib.compress(bytes(1 << 20), 9)
    assert len(small) < 2048
    answer = await server.answer(server.request("POST /login", small, f"Content-Encoding: {encoding}"))
    assert b"expected JSON" in answer
    chunked = server.request("POST /login").replace(b"Content-Length: 0", b"Transfer-Encoding: chunked")
    assert (await server.answer(chunked + b"1\r\nx\r\n" * 9))[9:12] == b"413"
    async with await server.open_client() as client:  # with a login the HTTP server reads the body itself
        headers = {"Content-Encoding": encoding}
        async with client.post(f"{server.url}/login", data=small, headers=headers) as found:
            assert found.status == 400


async def test_pages_of_other_origins_are_refused_before_they_count(server: AttackedServer) -> None:
    async with await server.open_client() as client:
        for site in ("cross-site", "same-site"):  # another port of this host is the same site: the cookie is sent
            headers = {"Sec-Fetch-Site": site, "Sec-Fetch-Mode": "no-cors"}
            for _ in range(300):
                assert (await client.get(f"{server.url}/main.js", headers=headers)).status == 403
        link = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
        assert (await client.get(f"{server.url}/login", headers=link)).status == 200
        assert (await client.get(f"{server.url}/main.js")).status == 200


def test_errors_of_connections_fill_no_log() -> None:
    lines, now = list[str](), [1000.0]
    rarely = Rarely(lines.append, lambda: now[0])
    for _ in range(10_000):
        rarely("connections cannot be accepted: too many open files")
    now[0] += 61.0
    rarely("again")
    assert lines == ["connections cannot be accepted: too many open files", "again (9999 more were left out before)"]
