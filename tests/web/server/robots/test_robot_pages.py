from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServer  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.robots.peer import PeerError  # noqa: E402
from ur.web.server.robots.robots import RobotEntry, ServerLogin  # noqa: E402


@dataclass
class PlayedRobots:
    """Robots without servers."""

    own: str = "sim"
    opened: list[tuple[str, Role]] = field(default_factory=list)

    async def list(self) -> list[RobotEntry]:
        return [
            RobotEntry("sim", "simulated robot", answers=True, open=True),
            RobotEntry("bob", "bob", answers=False, open=False),
        ]

    async def invite(self, name: str, role: Role) -> ServerLogin:
        if name != "bob":
            raise PeerError("this robot is not in the list")
        self.opened.append((name, role))
        return ServerLogin(8101, "secret")

    async def close(self) -> None:
        pass


@dataclass
class RobotPagesServer(PageServer):
    robots: PlayedRobots
    log: list[str]

    async def open(self, client: Any, body: Any) -> tuple[int, str]:
        async with client.post(f"{self.url}/api/robots", json=body) as answer:
            return answer.status, await answer.text()


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[RobotPagesServer]:
    port, robots, log = free_port(), PlayedRobots(), list[str]()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", log.append)
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "HOME": str(tmp_path)}
    application = Application(gate, {}, environment, "sim", log.append, robots)
    async with open_server(application.build(), gate, listen("127.0.0.1", port), log.append):
        yield RobotPagesServer(gate, f"http://127.0.0.1:{port}", robots, log)


async def test_list_marks_the_robot_that_is_shown(server: RobotPagesServer) -> None:
    async with await server.open_client(Role.LOOK) as client, client.get(f"{server.url}/api/robots") as answer:
        rows = await answer.json()
    assert [(row["name"], row["answers"], row["shown"]) for row in rows] == [("sim", True, True), ("bob", False, False)]


@pytest.mark.parametrize("role", [Role.LOOK, Role.DRIVE])
async def test_link_is_for_the_role_of_the_session_that_asks_whatever_the_request_says(
    server: RobotPagesServer, role: Role
) -> None:
    async with await server.open_client(role) as client:
        code, text = await server.open(client, {"name": "bob", "role": "drive"})
    assert (code, server.robots.opened) == (200, [("bob", role)])
    assert '"http://127.0.0.1:8101/login#secret"' in text
    assert "secret" not in "".join(server.log)


async def test_names_that_are_not_in_the_list_are_refused(server: RobotPagesServer) -> None:
    async with await server.open_client(Role.DRIVE) as client:
        for name in ("eve", "--phone", "../bob", "BOB", "bob:magni"):
            assert await server.open(client, {"name": name}) == (409, "this robot is not in the list\n")
        assert (await server.open(client, {"name": "sim"}))[0] == 409
        bodies: tuple[Any, ...] = ({"name": ""}, {"name": "x" * 64}, {"name": 1}, {"name": None}, {}, [], "bob", None)
        for body in bodies:
            assert (await server.open(client, body))[0] == 400, body
    assert server.robots.opened == []


async def test_second_login_of_a_browser_takes_the_place_of_its_first(server: RobotPagesServer) -> None:
    async with await server.open_client(Role.DRIVE) as client:
        (before,) = server.gate.sessions.list()
        server.gate.sessions.rename(before, "kitchen")
        token = server.gate.invite(Role.DRIVE)
        async with client.post(f"{server.url}/login", json={"token": token}) as answer:
            assert answer.status == 200
        async with client.post(f"{server.url}/login", json={"token": "wrong"}) as answer:
            assert answer.status == 403
        ((after, grant),) = server.gate.sessions.list().items()
        assert after != before
        assert grant.name == "kitchen"
        async with client.get(f"{server.url}/api/me") as answer:
            assert answer.status == 200
