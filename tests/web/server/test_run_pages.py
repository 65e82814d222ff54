"""Requests about runs over a real web socket: who may send them, and which are too old. No run is active."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServerClient  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.run_pages import RunPages  # noqa: E402


class RunPagesServer(PageServerClient):
    async def connect(self, role: Role = Role.DRIVE) -> Any:
        await self.log_in(role)
        return await self.client.ws_connect(f"{self.url}/ws/runs", headers={"Origin": self.url})


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[RunPagesServer]:
    async with serve(tmp_path) as server:
        yield server


@asynccontextmanager
async def serve(tmp_path: Path, **bounds: float) -> AsyncIterator[RunPagesServer]:
    port = free_port()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", lambda _: None)
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "HOME": str(tmp_path)}
    runs = RunPages(environment, lambda _: None, **bounds)  # type: ignore[arg-type]  # of numbers
    application = Application(gate, {}, environment, "bob", lambda _: None, runs=runs).build()
    async with (
        open_server(application, gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        yield RunPagesServer(gate, f"http://127.0.0.1:{port}", client)


async def ask(socket: Any, **message: Any) -> dict[str, Any]:
    await socket.send_json({"id": 1, **message})
    while (found := await socket.receive_json(timeout=30))["t"] != "answer":
        pass
    return dict(found)


END = {"t": "end", "run": "demo.7"}


async def test_page_gets_beat_and_state_and_an_answer(server: RunPagesServer) -> None:
    async with await server.connect() as socket:
        assert await socket.receive_json(timeout=30) == {"t": "beat", "n": 1}
        assert await socket.receive_json(timeout=30) == {"t": "runs", "runs": [], "ended": []}
        answer = await ask(socket, **END, n=1)
        assert (answer["id"], answer["ok"], answer["text"]) == (1, False, "run demo.7 has ended")
        change = {"t": "node", "run": "demo.7", "node": "/talk", "do": "stop"}
        assert (await ask(socket, **change, n=1))["text"] == "run demo.7 has ended"


async def test_role_that_looks_sees_runs_and_changes_nothing(server: RunPagesServer) -> None:
    async with await server.connect(Role.LOOK) as socket:
        assert (await socket.receive_json(timeout=30))["t"] == "beat"
        answer = await ask(socket, **END, n=1)
        assert not answer["ok"]
        assert "may look" in answer["text"]


async def test_request_with_a_beat_that_was_never_sent_is_not_carried_out(server: RunPagesServer) -> None:
    async with await server.connect() as socket:
        await socket.receive_json(timeout=30)
        assert "too slow" in (await ask(socket, **END, n=77))["text"]


async def test_request_that_has_waited_is_not_carried_out(tmp_path: Path) -> None:
    async with serve(tmp_path, oldest=0.0) as server, await server.connect() as socket:
        await socket.receive_json(timeout=30)
        assert "too slow" in (await ask(socket, **END, n=1))["text"]


async def test_page_that_sends_too_much_is_closed(server: RunPagesServer) -> None:
    async with await server.connect() as socket:
        for _ in range(100):
            await socket.send_json({**END, "n": 1, "id": 1})
        while not socket.closed:
            await socket.receive(timeout=30)
        assert socket.close_code == aiohttp.WSCloseCode.POLICY_VIOLATION


async def test_server_ends_at_once_while_pages_show_runs(server: RunPagesServer) -> None:
    sockets = [await server.connect() for _ in range(3)]
    await asyncio.gather(*(each.receive_json(timeout=30) for each in sockets))
