"""The server with real connections: who is let in, and what is refused. No robot runs."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from aiohttp import web  # noqa: E402
from tests.fakes.page_server import PageServerClient  # noqa: E402
from tests.web.server.robot_processes import KeptRobotEnd, keep  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.static_files import load_files  # noqa: E402
from ur.web.wire.frames import Kind, Layer, camera_frame, json_frame, key_of, points_frame  # noqa: E402

DRIVE = "/ws/drive?tab=0123456789ab"
RUNS = "/ws/runs"
PROGRAMS = ["/api/programs", "/api/graph", "/api/nodes", "/api/explain", "/api/doctor"]
GUARDED = ["/", "/main.js", "/api/me", "/ws/view", DRIVE, RUNS, *PROGRAMS]


@dataclass
class ApplicationServer(PageServerClient):
    application: Application
    log: list[str]
    robot_process: KeptRobotEnd

    @property
    def origin(self) -> dict[str, str]:
        return {"Origin": self.url}

    async def status(self, method: str, path: str, **headers: str) -> int:
        async with self.client.request(method, self.url + path, headers=headers) as answer:
            assert len(await answer.text()) < 5000 or answer.status == 200
            return int(answer.status)


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[ApplicationServer]:
    port, log = free_port(), list[str]()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", log.append)
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    ends = list[KeptRobotEnd]()
    application = Application(gate, load_files(), environment, "bob", log.append, make_robot_process=keep(ends))
    jar = aiohttp.CookieJar(unsafe=True)
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), log.append),
        aiohttp.ClientSession(cookie_jar=jar) as client,
    ):
        yield ApplicationServer(gate, f"http://127.0.0.1:{port}", client, application, log, ends[0])


async def test_nothing_but_the_login_is_seen_without_a_session(server: ApplicationServer) -> None:
    for path in GUARDED:
        assert await server.status("GET", path, **server.origin) == 403, path
    for path in ("/api/stop", "/logout"):
        assert await server.status("POST", path, **server.origin) == 403, path
    for path in ("/login", "/login.js", "/style.css", "/texts.js"):
        assert await server.status("GET", path) == 200, path


async def test_browser_without_a_session_is_shown_the_page_of_the_login(server: ApplicationServer) -> None:
    for path in ("/", "/api/me"):
        async with server.client.get(server.url + path, headers={"Accept": "text/html,*/*"}) as answer:
            assert (answer.url.path, answer.status) == ("/login", 200)
            assert "Content-Security-Policy" in answer.history[0].headers
            assert "login.js" in await answer.text()


async def test_other_hosts_and_origins_are_refused_even_with_a_session(server: ApplicationServer) -> None:
    await server.log_in()
    for path in [*GUARDED, "/login"]:
        assert await server.status("GET", path, Host="evil.example") == 421, path
    for path in ("/ws/view", DRIVE, RUNS):
        assert await server.status("GET", path, Origin="http://evil.example") == 403
        assert await server.status("GET", path) == 403
    assert await server.status("POST", "/api/stop", Origin="http://evil.example") == 403
    assert await server.status("POST", "/api/stop") == 403


async def test_link_is_good_once_and_wrong_ones_are_limited(server: ApplicationServer) -> None:
    token = server.gate.invite(Role.DRIVE)
    codes = []
    for value in (token, token, "wrong", *["x"] * 20):
        async with server.client.post(f"{server.url}/login", json={"token": value}, headers=server.origin) as answer:
            codes.append(answer.status)
    assert codes[:3] == [200, 403, 403]
    assert codes[-1] == 429


@pytest.mark.parametrize("body", ["", "[]", "{", '{"token": 3}', "[" * 1500, "x" * 5000])
async def test_malformed_logins_are_refused_in_a_line(server: ApplicationServer, body: str) -> None:
    async with server.client.post(f"{server.url}/login", data=body, headers=server.origin) as answer:
        assert answer.status in (400, 403, 413)
        assert "Traceback" not in await answer.text()


@pytest.mark.parametrize("charset", ["bogus", "utf-16", "idna", "'"])
async def test_login_with_a_strange_charset_is_refused_in_a_line(server: ApplicationServer, charset: str) -> None:
    headers = {**server.origin, "Content-Type": f"application/json; charset={charset}"}
    async with server.client.post(f"{server.url}/login", data=b"\xff{", headers=headers) as answer:
        assert answer.status == 400
        assert await answer.text() == "expected JSON\n"


@pytest.mark.parametrize(
    "path", ["/../serve.py", "/%2e%2e/serve.py", "/static/", "/x.js", "/.bashrc", "/main.js/", "//"]
)
async def test_only_files_of_the_page_are_served(server: ApplicationServer, path: str) -> None:
    await server.log_in()
    assert await server.status("GET", path) in (403, 404)


async def test_answers_forbid_scripts_and_frames_of_others(server: ApplicationServer) -> None:
    await server.log_in()
    for path in ("/", "/login", "/x.js", "/api/me"):
        async with server.client.get(server.url + path) as answer:
            policy = answer.headers["Content-Security-Policy"]
            assert "default-src 'none'" in policy
            assert "unsafe" not in policy
            assert answer.headers["X-Content-Type-Options"] == "nosniff"
            assert answer.headers["Server"] == "ur"
    for name, file in load_files().items():
        if name.endswith(".html"):
            assert b"<script>" not in file.plain
            assert b" style=" not in file.plain
            assert b"//" not in file.plain.replace(b"<!doctype", b""), name


async def test_page_is_small_and_is_not_sent_twice(server: ApplicationServer) -> None:
    await server.log_in()
    assert sum(len(file.packed) for file in load_files().values()) < 250_000
    async with server.client.get(f"{server.url}/main.js") as answer:
        tag = answer.headers["ETag"]
    assert await server.status("GET", "/main.js", **{"If-None-Match": tag}) == 304


async def test_role_that_looks_sees_the_robot_and_cannot_drive(server: ApplicationServer) -> None:
    await server.log_in(Role.LOOK)
    assert await server.status("GET", DRIVE, **server.origin) == 403
    assert await server.status("POST", "/api/stop", **server.origin) == 503  # allowed; no robot runs
    async with server.client.ws_connect(f"{server.url}/ws/view", headers=server.origin) as socket:
        frame = await socket.receive_bytes(timeout=30)
        assert key_of(frame)[0] == Kind.SERVER
        assert b'"no master"' in frame
        await socket.send_str('{"t": "stop"}')
        while (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.BINARY:
            pass
        assert socket.close_code == aiohttp.WSCloseCode.POLICY_VIOLATION


async def test_page_gets_only_the_layers_that_it_asks_for(server: ApplicationServer) -> None:
    await server.log_in()
    assert await server.status("GET", "/ws/view?layers=../x", **server.origin) == 400
    socket = await server.client.ws_connect(f"{server.url}/ws/view?layers=plan", headers=server.origin)
    async with socket:
        assert key_of(await socket.receive_bytes(timeout=30))[0] == Kind.SERVER  # it is one of the viewers now
        for layer in (Layer.SCAN, Layer.GLOBAL, Layer.PLAN):
            server.application.show(points_frame(layer, [(1.0, 2.0)]))
        found = key_of(await socket.receive_bytes(timeout=30))
        while found[0] == Kind.SERVER:
            found = key_of(await socket.receive_bytes(timeout=30))
        assert found[:2] == (Kind.POINTS, Layer.PLAN)


async def test_page_changes_what_it_shows_over_its_open_connection(server: ApplicationServer) -> None:
    asked: list[tuple[int, bool, list[str]]] = []

    def look(viewers: int, layers: frozenset[Layer], plots: frozenset[str], _camera: str) -> None:
        asked.append((viewers, Layer.GLOBAL in layers, sorted(plots)))

    server.robot_process.on_look = look
    await server.log_in(Role.LOOK)
    newest = points_frame(Layer.GLOBAL, [(1.0, 2.0)])  # before the page shows that layer
    server.application.show(newest)
    async with server.client.ws_connect(f"{server.url}/ws/view?layers=plan", headers=server.origin) as socket:
        await socket.send_json({"layers": "plan,global", "plots": "/a:x"})
        while await socket.receive_bytes(timeout=30) != newest:
            pass
        await socket.send_json({"layers": "plan"})
        await socket.send_json({"layers": "everything"})
        while (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.BINARY:
            pass
        assert socket.close_code == aiohttp.WSCloseCode.POLICY_VIOLATION
    assert asked[:3] == [(1, False, []), (1, True, ["/a:x"]), (1, False, [])]


async def test_page_that_changes_too_often_is_closed(server: ApplicationServer) -> None:
    await server.log_in(Role.LOOK)
    async with server.client.ws_connect(f"{server.url}/ws/view", headers=server.origin) as socket:
        for _ in range(100):
            await socket.send_json({"layers": "plan"})
        while (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.BINARY:
            pass
        assert socket.close_code == aiohttp.WSCloseCode.POLICY_VIOLATION


async def test_flood_of_requests_reaches_the_robot_and_is_logged_up_to_a_limit(server: ApplicationServer) -> None:
    await server.log_in(Role.DRIVE)
    async with server.client.ws_connect(server.url + DRIVE, headers=server.origin) as socket:
        for _ in range(140):
            await socket.send_str('{"t":"stop"}')
        while sum("stop" in str(each.get("m")) for each in server.robot_process.passed) < 140:
            assert not socket.closed
            await asyncio.sleep(0.01)
    assert 100 <= sum('"stop"' in line for line in server.log) < 120


@pytest.mark.parametrize("path", ["/ws/view", "/ws/camera", "/ws/data", RUNS, DRIVE])
@pytest.mark.parametrize("kind", ["ping", "pong"])
async def test_page_that_sends_more_pings_than_a_browser_is_closed(
    server: ApplicationServer, path: str, kind: str
) -> None:
    await server.log_in(Role.DRIVE)
    socket = await server.client.ws_connect(server.url + path, headers=server.origin, autoping=False, heartbeat=None)
    async with socket:
        with suppress(ConnectionError):
            for _ in range(100):
                await getattr(socket, kind)(b"x")
        while (await socket.receive(timeout=5.0)).type not in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED):
            pass
        assert socket.close_code in (1008, 1006)  # the reason, unless the connection is reset first


async def test_camera_has_a_socket_of_its_own_and_waits_for_the_page(server: ApplicationServer) -> None:
    come = asyncio.Event()

    def look(_viewers: int, layers: frozenset[Layer], _plots: frozenset[str], _camera: str) -> None:
        if Layer.CAMERA in layers:
            come.set()

    server.robot_process.on_look = look
    await server.log_in(Role.LOOK)
    assert await server.status("GET", "/ws/camera", Origin="http://evil.example") == 403
    async with server.client.ws_connect(f"{server.url}/ws/camera", headers=server.origin) as socket:
        await come.wait()
        frames = [camera_frame(float(number), b"jpeg") for number in range(10)]
        server.application.show(frames[0])
        got = [await socket.receive_bytes(timeout=30)]
        server.application.show(frames[1])
        got.append(await socket.receive_bytes(timeout=30))
        for frame in frames[2:]:
            server.application.show(frame)
        await socket.send_str("shown")
        got.append(await socket.receive_bytes(timeout=30))
        assert got == [frames[0], frames[1], frames[9]]
        for _ in range(100):
            await socket.send_str("shown")
        assert (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.CLOSE


@pytest.mark.parametrize(
    ("role", "text", "passed"),
    [
        (Role.DRIVE, "/rear/image", ["/rear/image"]),
        (Role.DRIVE, "/rear/image?", []),
        (Role.DRIVE, "rear", []),
        (Role.DRIVE, "/" + "a" * 201, []),
        (Role.LOOK, "/rear/image", []),
    ],
)
async def test_camera_is_chosen_for_all_pages_by_those_that_may_drive(
    server: ApplicationServer, role: Role, text: str, passed: list[str]
) -> None:
    chosen, done = list[str](), asyncio.Event()

    def look(_viewers: int, _layers: frozenset[Layer], _plots: frozenset[str], camera: str) -> None:
        if camera:
            chosen.append(camera)
            done.set()

    server.robot_process.on_look = look
    await server.log_in(role)
    async with server.client.ws_connect(f"{server.url}/ws/camera", headers=server.origin) as socket:
        await socket.send_str(text)
        if not passed:
            assert (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.CLOSE
            assert socket.close_code == aiohttp.WSCloseCode.POLICY_VIOLATION
        else:
            await asyncio.wait_for(done.wait(), 30)
    assert chosen[:1] == passed


async def test_page_that_sends_rubbish_is_closed(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(server.url + DRIVE, headers=server.origin) as socket:
        assert (await socket.receive_json(timeout=30))["t"] == "hello"
        for _ in range(30):
            await socket.send_str('{"t": "stick"}')
        assert (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.CLOSE
    async with server.client.ws_connect(server.url + DRIVE, headers=server.origin) as socket:
        await socket.receive_json(timeout=30)
        await socket.send_str("x" * 5000)
        assert (await socket.receive(timeout=30)).type is aiohttp.WSMsgType.CLOSE
    assert await server.status("GET", "/ws/drive?tab=../../x", **server.origin) == 400


async def test_page_that_is_opened_again_replaces_its_older_connection(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(server.url + DRIVE, headers=server.origin) as first:
        client = (await first.receive_json(timeout=30))["client"]
        async with server.client.ws_connect(server.url + DRIVE, headers=server.origin) as second:
            assert (await second.receive_json(timeout=30))["client"] == client
            assert (await first.receive(timeout=30)).type is aiohttp.WSMsgType.CLOSE


async def test_second_login_of_a_browser_takes_the_place_of_its_first(server: ApplicationServer) -> None:
    await server.log_in()
    (before,) = server.gate.sessions.list()
    server.gate.sessions.rename(before, "kitchen")
    await server.log_in()
    assert (await server.post("/login", {"token": "wrong"}))[0] == 403
    ((after, grant),) = server.gate.sessions.list().items()
    assert after != before
    assert grant.name == "kitchen"
    assert await server.read("/api/me")


async def test_logout_ends_the_session(server: ApplicationServer) -> None:
    await server.log_in()
    assert await server.status("GET", "/api/me") == 200
    assert await server.status("POST", "/logout", **server.origin) == 200
    assert await server.status("GET", "/api/me") == 403


async def test_plots_of_all_pages_are_asked_for_once_and_only_they_get_the_numbers(server: ApplicationServer) -> None:
    asked: list[tuple[int, bool, list[str]]] = []

    def look(viewers: int, layers: frozenset[Layer], plots: frozenset[str], _camera: str) -> None:
        asked.append((viewers, Layer.PLOTS in layers, sorted(plots)))

    server.robot_process.on_look = look
    await server.log_in(Role.LOOK)
    view = f"{server.url}/ws/view?layers="
    assert await server.status("GET", "/ws/view?plots=odom", **server.origin) == 400
    async with AsyncExitStack() as stack:
        sockets = [
            await stack.enter_async_context(server.client.ws_connect(view + plots, headers=server.origin))
            for plots in ("", "&plots=/a:x,/b:y", "&plots=/a:x")
        ]
        assert asked == [(1, False, []), (2, True, ["/a:x", "/b:y"]), (3, True, ["/a:x", "/b:y"])]
        values = json_frame(Kind.VALUES, {"t": 1.0, "v": {"/a:x": 2.0}}, Layer.PLOTS)
        after = json_frame(Kind.ZONES, {})  # less urgent
        server.application.show(values)
        server.application.show(after)
        for socket, plots in zip(sockets, (False, True, True), strict=True):
            got: list[bytes] = []
            while after not in got:  # the state of the server comes in between
                got.append(await socket.receive_bytes(timeout=30))
            assert (values in got) is plots


async def test_server_ends_although_a_cancellation_is_lost(tmp_path: Path) -> None:
    lost = 0

    class DeafRobotEnd(KeptRobotEnd):
        async def run(self) -> None:
            nonlocal lost
            try:
                await asyncio.Event().wait()
            except asyncio.CancelledError:
                lost += 1
            await asyncio.Event().wait()

    gate = LoginGate(make_origins((), free_port()), tmp_path / "sessions.json", lambda _: None)
    application = Application(gate, load_files(), {}, "bob", lambda _: None, make_robot_process=DeafRobotEnd)
    runner = web.AppRunner(application.build(), access_log=None)
    await runner.setup()
    await asyncio.sleep(0)
    await asyncio.wait_for(runner.cleanup(), 60.0)
    assert lost == 1
