"""Devices that have logged in: seen, named, ended and invited, over real connections."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServer  # noqa: E402
from tests.web.server.robot_processes import KeptRobotEnd, keep  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import DAY, Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402

DRIVE = "/ws/drive?tab=0123456789ab"


@dataclass
class SessionServer(PageServer):
    path: Path
    said: list[str]
    passed: list[Any]

    async def list(self, client: Any) -> list[dict[str, Any]]:
        async with client.get(f"{self.url}/api/sessions") as answer:
            assert answer.status == 200
            return list(await answer.json())

    async def post(self, client: Any, path: str, **value: Any) -> tuple[int, Any]:
        async with client.post(self.url + path, json=value) as answer:
            return answer.status, await (answer.json() if answer.status == 200 else answer.text())


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[SessionServer]:
    port, said, path = free_port(), list[str](), tmp_path / "sessions-8090.json"
    origins = make_origins((), port)
    gate = LoginGate(origins, path, lambda _: None, report=said.append, life=7 * DAY)
    environment, ends = {"ROS_MASTER_URI": f"http://localhost:{free_port()}"}, list[KeptRobotEnd]()
    application = Application(gate, {}, environment, "bob", lambda _: None, make_robot_process=keep(ends))
    async with open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None):
        yield SessionServer(gate, f"http://127.0.0.1:{port}", path, said, ends[0].passed)


async def test_list_says_who_has_logged_in_and_the_terminal_said_it_at_once(server: SessionServer) -> None:
    clients = [await server.open_client(), await server.open_client(), await server.open_client(Role.LOOK, "iPhone")]
    rows = await server.list(clients[1])
    assert (rows[0]["own"], rows[0]["name"]) == (True, "Linux 2")
    assert {(row["name"], row["role"]) for row in rows[1:]} == {("Linux", "drive"), ("iPhone", "look")}
    assert {row["address"] for row in rows} == {"127.0.0.1"}
    assert all(abs(row["until"] - row["first"] - 7 * DAY) < 1.0 for row in rows)
    assert [line[9:] for line in server.said] == [
        "Linux logged in from 127.0.0.1 and may drive",
        "Linux 2 logged in from 127.0.0.1 and may drive",
        "iPhone logged in from 127.0.0.1 and may look",
    ]
    for client in clients:
        await client.close()


async def test_end_of_a_session_closes_its_pages_and_no_other(server: SessionServer) -> None:
    own, other = await server.open_client(), await server.open_client()
    async with own, other:
        mine = await own.ws_connect(server.url + DRIVE)
        theirs = await other.ws_connect(server.url + DRIVE)
        for each in (mine, theirs):
            assert (await each.receive_json(timeout=30))["t"] == "hello"
        (row,) = [row for row in await server.list(own) if not row["own"]]
        assert row["open"]
        assert await server.post(own, "/api/sessions/end", id=row["id"]) == (200, {"ended": 1})
        while not theirs.closed:
            await theirs.receive(timeout=30)
        assert (await other.get(f"{server.url}/api/me")).status == 403
        assert (await own.get(f"{server.url}/api/me")).status == 200
        assert not mine.closed
        assert (await server.post(own, "/api/sessions/end", id=row["id"]))[0] == 404
        third = await server.open_client()
        assert await server.post(own, "/api/sessions/end", id="others") == (200, {"ended": 1})
        assert len(await server.list(own)) == 1
        await third.close()
        await mine.close()


async def test_names_are_chosen_by_people_and_stay_unambiguous(server: SessionServer) -> None:
    own, other, guest = await server.open_client(), await server.open_client(), await server.open_client(Role.LOOK)
    async with own, other, guest:
        async with own.ws_connect(server.url + DRIVE) as page, own.ws_connect(server.url + DRIVE + "c") as second:
            assert (await page.receive_json(timeout=30))["name"] == "Linux"
            assert (await second.receive_json(timeout=30))["name"] == "Linux, page 2"
            rows = await server.list(own)
            mine = rows[0]["id"]
            assert await server.post(own, "/api/sessions/name", id=mine, name=" Ada \n") == (200, {"name": "Ada"})
            names = [each["name"] for each in server.passed if each.get("do") == "name"]
            assert names == ["Ada", "Ada, page 2"]
        async with own.ws_connect(server.url + DRIVE + "c") as page:
            assert (await page.receive_json(timeout=30))["name"] == "Ada, page 2"
        looker = next(number for number, grant in server.gate.sessions.list().items() if grant.role is Role.LOOK)
        assert (await server.post(guest, "/api/sessions/name", id=looker, name="ada"))[1] == {"name": "ada 2"}
        assert (await server.post(guest, "/api/sessions/name", id=mine, name="x"))[0] == 403
        assert (await server.post(own, "/api/sessions/name", id="nothing", name="x"))[0] == 404
        for bad in ("", "\x1b", 7, None):
            assert (await server.post(own, "/api/sessions/name", id=mine, name=bad))[0] == 400


async def test_look_invites_those_who_look_and_nobody_who_drives(server: SessionServer) -> None:
    driver, guest = await server.open_client(), await server.open_client(Role.LOOK)
    async with driver, guest:
        assert (await server.post(guest, "/api/invite", role="drive"))[0] == 403
        for client, role in ((guest, "look"), (driver, "look"), (driver, "drive")):
            code, found = await server.post(client, "/api/invite", role=role)
            assert code == 200
            assert found["code"].startswith("<svg")
            assert found["local"]
            address, _, token = found["link"].partition("/login#")
            assert address == server.url
            invited = await server.open_client(token=token)
            assert (await (await invited.get(f"{server.url}/api/me")).json())["role"] == role
            await invited.close()
        for bad in ("root", None, ["drive"]):
            assert (await server.post(driver, "/api/invite", role=bad))[0] == 400
        codes = [(await server.post(guest, "/api/invite", role="look"))[0] for _ in range(15)]
        assert codes[-1] == 429
