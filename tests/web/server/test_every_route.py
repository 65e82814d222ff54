"""Every route of the server, from its own table: a new one fails here until it is classified, and then is tested."""

import time
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServerClient  # noqa: E402
from tests.web.server.robot_processes import KeptRobotEnd, keep  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import SESSION_LIFE, TOKEN_LIFE, Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import VIEWER_PATH, LoginGate  # noqa: E402
from ur.web.server.static_files import load_files  # noqa: E402

FILE = "/{name}"
OPEN = {("GET", "/login"), ("POST", "/login")}  # before a login
LOOK = {  # for every login
    ("GET", "/"),
    ("GET", FILE),
    ("GET", "/api/me"),
    ("GET", "/api/programs"),
    ("GET", "/api/graph"),
    ("GET", "/api/nodes"),
    ("GET", "/api/explain"),
    ("GET", "/api/doctor"),
    ("GET", "/ws/view"),
    ("GET", "/ws/camera"),
    ("GET", "/three.js"),
    ("GET", "/ws/data"),  # as /ws/runs
    ("GET", "/api/recordings"),  # without the files: tests/web/server/recordings
    ("GET", "/api/replay"),
    ("GET", "/api/maps"),  # without pictures: test_map_pages
    ("GET", "/ws/runs"),  # what changes something is refused there: test_role_that_looks_changes_nothing
    ("POST", "/api/stop"),  # the emergency stop is for every role
    ("POST", "/logout"),
    ("POST", "/api/sessions/name"),  # its own name: test_sessions
    ("POST", "/api/assistants/end"),  # as the emergency stop
    ("POST", "/api/invite"),  # others who may look: test_sessions
}
DRIVE = {  # for logins that may drive
    ("GET", "/ws/drive"),
    ("GET", "/api/sessions"),
    ("POST", "/api/sessions/end"),
    ("GET", "/api/recordings/topics"),
    ("GET", "/api/recordings/file"),
    ("POST", "/api/recordings/start"),
    ("POST", "/api/recordings/stop"),
    ("POST", "/api/recordings/delete"),
    ("POST", "/api/replay"),
    ("POST", "/api/assistants/grant"),
}
VIEWER = {("GET", VIEWER_PATH)}  # by the secret in the address: no cookie counts
EVIL = "http://evil.example"
OLD = "x" * 43


@dataclass
class RouteServer(PageServerClient):
    routes: set[tuple[str, str]]
    passed: list[Any]
    ahead: list[float]  # s of the server's clock

    async def refuse(self, method: str, path: str, **headers: str) -> int:
        """The status; what is refused is refused in a line that holds no secret."""
        path = path.replace(FILE, "/main.js")
        query = "?tab=0123456789&program=x&node=/x"
        async with self.client.request(method, f"{self.url}{path}{query}", headers=headers) as answer:
            text = await answer.text()
            if answer.status >= 400:
                assert text.count("\n") <= 1
                assert len(text) < 200
                assert "Traceback" not in text
                assert str(Path.home()) not in text
                assert answer.headers["X-Content-Type-Options"] == "nosniff"
            return int(answer.status)


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[RouteServer]:
    port, ends, ahead = free_port(), list[KeptRobotEnd](), [0.0]
    gate = LoginGate(
        make_origins((), port), tmp_path / "sessions.json", lambda _: None, clock=lambda: time.time() + ahead[0]
    )
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "HOME": str(tmp_path)}
    application = Application(gate, load_files(), environment, "bob", lambda _: None, make_robot_process=keep(ends))
    built = application.build()
    routes = {
        (each.method, each.resource.canonical)
        for each in built.router.routes()
        if each.method != "HEAD" and each.resource is not None
    }
    async with (
        open_server(built, gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        yield RouteServer(gate, f"http://127.0.0.1:{port}", client, routes, ends[0].passed, ahead)


async def test_every_route_is_classified(server: RouteServer) -> None:
    assert server.routes == OPEN | LOOK | DRIVE | VIEWER


async def test_every_route_but_the_login_is_refused_without_a_session(server: RouteServer) -> None:
    for cookie in ({}, {"Cookie": f"{server.gate.cookie}={OLD}"}, {"Cookie": f"{server.gate.cookie}="}):
        for method, path in server.routes - OPEN:
            for each in (method, "HEAD") if method == "GET" else (method,):
                assert await server.refuse(each, path, Origin=server.url, **cookie) == 403, (each, path)
    assert server.passed == []


async def test_every_route_is_refused_under_another_host(server: RouteServer) -> None:
    await server.log_in(Role.DRIVE)
    for host in ("evil.example", "127.0.0.1.evil.example", ""):
        for method, path in server.routes:
            assert await server.refuse(method, path, Host=host, Origin=server.url) in (400, 421), (path, host)
    assert server.passed == []


async def test_every_route_that_changes_or_streams_is_refused_to_another_origin(server: RouteServer) -> None:
    await server.log_in(Role.DRIVE)
    changing = {each for each in server.routes if each[0] != "GET" or each[1].startswith("/ws/")} | VIEWER
    assert len(changing) >= 8
    for method, path in changing:
        for origin in ({"Origin": EVIL}, {"Origin": "null"}, {"Origin": server.url + "0"}, {}):
            assert await server.refuse(method, path, **origin) == 403, (path, origin)
    for method, path in server.routes - changing:  # what only reads gives nothing to scripts of others
        async with server.client.request(method, server.url + path.replace(FILE, "/main.js")) as answer:
            assert answer.headers["Cross-Origin-Resource-Policy"] == "same-origin"
            assert "Access-Control-Allow-Origin" not in answer.headers
    assert server.passed == []


async def test_every_route_is_refused_to_a_session_that_is_too_old(server: RouteServer) -> None:
    token = server.gate.invite(Role.DRIVE)
    await server.log_in(Role.DRIVE)
    server.ahead[0] = TOKEN_LIFE + 1.0
    async with server.client.post(
        f"{server.url}/login", json={"token": token}, headers={"Origin": server.url}
    ) as answer:
        assert answer.status == 403
    server.ahead[0] += 2 * SESSION_LIFE
    for method, path in server.routes - OPEN:
        assert await server.refuse(method, path, Origin=server.url) == 403, path
    assert server.passed == []


async def test_every_route_of_drivers_is_refused_to_the_role_that_looks(server: RouteServer) -> None:
    await server.log_in(Role.LOOK)
    for method, path in DRIVE | VIEWER:
        assert await server.refuse(method, path, Origin=server.url) == 403, path
    assert server.passed == []


async def test_role_that_looks_changes_nothing(server: RouteServer) -> None:
    await server.log_in(Role.LOOK)
    requests: tuple[dict[str, Any], ...] = (
        {"t": "start", "program": "robot_base", "arguments": {}},
        {"t": "node", "run": "m_make_map.12", "node": "/amcl", "do": "restart"},
        {"t": "end", "run": "m_make_map.12"},
    )
    async with server.client.ws_connect(f"{server.url}/ws/runs", headers={"Origin": server.url}) as socket:
        beat = (await socket.receive_json(timeout=30))["n"]
        for number, request in enumerate(requests, 1):
            await socket.send_json({"id": number, "n": beat, **request})
            while (answer := await socket.receive_json(timeout=30))["t"] != "answer":
                pass
            assert (answer["id"], answer["ok"]) == (number, False)
            assert "may look" in answer["text"]
    assert server.passed == []


async def test_role_that_looks_chooses_no_arguments_of_launch_files(server: RouteServer) -> None:
    path = "%s?program=robot_base&node=/amcl&arguments=%s"
    await server.log_in(Role.LOOK)
    for route in ("/api/nodes", "/api/graph", "/api/explain"):
        address = server.url + path % (route, '{"params":"/etc/passwd"}')
        async with server.client.get(address) as answer:
            assert answer.status == 403, route
            assert "default values" in await answer.text()
