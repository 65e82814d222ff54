"""Assistants over HTTP: the SDK's client, the server of `ur web`, and a robot on a bus in real time."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mcp")
pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

import aiohttp
import httpx2
from mcp.client import Client
from mcp.client.streamable_http import streamable_http_client
from mcp.shared._httpx_utils import create_mcp_http_client
from tests.fakes.page_server import PageServerClient
from tests.mcp.robot import STEP, AssistedRobot, text_of
from tests.ros_session import free_port
from tests.web.server.robot_ends import IdleRobotEnd, keep

from ur.mcp.action_log import ActionLog
from ur.web.access.origin import make_origins
from ur.web.access.roles import Role
from ur.web.server.application import Application
from ur.web.server.assistants.assistant_pages import AssistantPages
from ur.web.server.assistants.assistant_servers import AssistantServers
from ur.web.server.connections.http_server import open_server
from ur.web.server.connections.listener import listen
from ur.web.server.logins.gate import LoginGate


class ConnectedAssistant(PageServerClient):
    """A page that may drive, and an assistant that it has connected."""

    robot: AssistedRobot
    pages: AssistantPages
    settings: dict[str, str]
    http: httpx2.AsyncClient

    async def post(self, what: str, value: object) -> tuple[int, Any]:
        """What the server answers to a request of the page."""
        address, origin = f"{self.url}/api/assistants/{what}", {"Origin": self.url}
        async with self.client.post(address, json=value, headers=origin) as answer:
            text = await answer.text()
            return answer.status, json.loads(text) if answer.status == 200 else text

    def find(self) -> dict[str, Any]:
        """The assistant, as pages see it."""
        (found,) = self.pages.describe()
        return found

    @contextlib.asynccontextmanager
    async def connect(self, mode: str = "auto") -> AsyncIterator[Client]:
        """The SDK's client, with the secret."""
        headers = {"Authorization": f"Bearer {self.settings['secret']}"}
        async with (
            create_mcp_http_client(headers=headers) as http,
            Client(streamable_http_client(self.settings["url"], http_client=http), mode=mode) as client,
        ):
            self.http = http
            yield client

    async def wait_for(self, condition: Any) -> None:
        """Wait for something on the robot or the page."""
        for _ in range(3000):
            if condition():
                return
            await asyncio.sleep(0.01)
        raise AssertionError(self.robot.assistant.log.read())

    def moves(self) -> bool:
        """Whether the robot moves now."""
        return self.robot.samples[-1][1] > 0.08


@pytest.fixture
async def assistant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[ConnectedAssistant]:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    robot, port, ends = AssistedRobot(tmp_path), free_port(), list[Any]()
    robot.assistant.end()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", lambda _: None)
    environment = {"ROS_MASTER_URI": "http://localhost:1", "HOME": str(tmp_path)}
    servers = AssistantServers(environment, robot.files, lambda _: None, lambda *_: robot.link)  # type: ignore[arg-type]
    pages = AssistantPages(gate, environment, lambda _: None, robot.files, servers)
    application = Application(
        gate, {}, environment, "bob", lambda _: None, make_robot_end=keep(ends, IdleRobotEnd), assistants=pages
    )

    async def pass_time() -> None:
        while True:  # not faster than real time: requests and answers need some of it, also on a busy computer
            robot.step()
            await asyncio.sleep(STEP)

    passing = asyncio.create_task(pass_time())
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        found = ConnectedAssistant(gate, f"http://127.0.0.1:{port}", client)
        found.robot, found.pages = robot, pages
        await found.log_in(Role.DRIVE)
        status, found.settings = await found.post("connect", {"name": "Ada's helper"})
        assert status == 200
        yield found
    passing.cancel()


async def test_grant_of_the_page_lets_an_assistant_drive_until_it_is_taken_back(assistant: ConnectedAssistant) -> None:
    async with assistant.connect() as client:
        assert "pose" in text_of(await client.call_tool("look", {}))
        assert "no grant" in text_of(await client.call_tool("drive", {"forward": 0.2}))
        await client.call_tool("ask_to_drive", {"reason": "to look at the door", "minutes": 5.0, "speed": 0.3})
        asking = assistant.find()
        assert (asking["name"], asking["asks"]["reason"], asking["grant"]) == (
            "Ada's helper",
            "to look at the door",
            None,
        )
        kitchen = {"left": 4.0, "bottom": 1.0, "right": 2.0, "top": -1.0, "name": "kitchen"}
        given = {"id": asking["id"], "minutes": 5.0, "speed": 0.2, "avoid": [kitchen]}
        status, answer = await assistant.post("grant", given)
        assert status == 200, answer
        assert answer["text"].endswith(", not kitchen")
        assert assistant.find()["asks"] is None
        driving = asyncio.create_task(client.call_tool("drive", {"forward": 0.15, "turn": 0.3, "seconds": 5.0}))
        await assistant.wait_for(assistant.moves)
        assert (await assistant.post("end", {"id": asking["id"]}))[0] == 200
        assert "no grant" in text_of(await driving)
        assert assistant.find()["grant"] is None
    actions = [json.loads(line) for line in ActionLog(assistant.robot.files.log).read()]
    results = [each["result"] for each in actions if each["action"] == "grant"]
    assert "lets Ada's helper drive" in results[0]
    assert "does not let Ada's helper drive any more" in results[1]


@pytest.mark.parametrize("silence", ["logout", "hang"])
async def test_robot_is_at_rest_soon_after_a_remote_assistant_falls_silent(
    assistant: ConnectedAssistant, silence: str
) -> None:
    async with contextlib.AsyncExitStack() as stack:
        client = await stack.enter_async_context(assistant.connect())
        await client.call_tool("look", {})
        await assistant.post("grant", {"id": assistant.find()["id"], "minutes": 5.0, "speed": 0.3})
        driving = asyncio.create_task(client.call_tool("drive", {"forward": 0.15, "turn": 0.3, "seconds": 5.0}))
        await assistant.wait_for(assistant.moves)
        if silence == "logout":
            (number,) = [id for id, each in assistant.gate.sessions.list().items() if each.role is Role.ASSIST]
            assistant.gate.sessions.end([number])
        else:  # its answers arrive no more
            assistant.http.event_hooks = {"request": [hang]}
        silent_at = assistant.robot.now
        await assistant.wait_for(lambda: assistant.robot.now > silent_at + 1.2)
        late = [speed for at, speed, *_ in assistant.robot.samples if at >= silent_at + 0.3]
        assert max(late) < 0.01
        driving.cancel()
        await asyncio.gather(driving, return_exceptions=True)
        assistant.http.event_hooks = {}
        with contextlib.suppress(Exception):
            await stack.aclose()


async def hang(*_: object) -> None:
    """Send nothing."""
    await asyncio.Event().wait()


async def test_version_that_lets_a_server_ask_nothing_is_refused_over_http(assistant: ConnectedAssistant) -> None:
    headers = {"Authorization": f"Bearer {assistant.settings['secret']}", "MCP-Protocol-Version": "2026-07-28"}
    async with assistant.client.post(assistant.settings["url"], json={}, headers=headers) as answer:
        assert answer.status == 400
        refusal = (await answer.json())["error"]
    assert "signs of life" in refusal["message"]
    assert "2025-11-25" in refusal["data"]["supported"]


async def test_assistant_without_its_secret_is_refused(assistant: ConnectedAssistant) -> None:
    for headers in ({}, {"Authorization": "Bearer wrong"}, {"Authorization": "Basic x"}):  # with the page's cookie
        async with assistant.client.post(assistant.settings["url"], json={}, headers=headers) as answer:
            assert answer.status == 403
            assert "Assistants" in await answer.text()


async def test_secret_of_an_assistant_opens_nothing_else(assistant: ConnectedAssistant) -> None:
    secret = assistant.settings["secret"]
    cookie = {"Cookie": f"{assistant.gate.cookie}={secret}", "Origin": assistant.url}
    async with aiohttp.ClientSession() as stranger:
        for headers in (cookie, {"Authorization": f"Bearer {secret}", "Origin": assistant.url}):
            for method, path in (("GET", "/api/me"), ("POST", "/api/stop"), ("GET", "/ws/view")):
                async with stranger.request(method, assistant.url + path, headers=headers) as answer:
                    assert answer.status == 403, path
        evil = {"Authorization": f"Bearer {secret}", "Origin": "http://evil.example"}
        async with stranger.post(assistant.settings["url"], json={}, headers=evil) as answer:
            assert answer.status == 403


BEYOND: tuple[tuple[dict[str, Any], str], ...] = (
    ({"id": "zz", "minutes": 5, "speed": 0.2}, "id"),
    ({"id": "00000000", "minutes": 5, "speed": 0.2}, "has ended"),
    ({"id": "00000000", "minutes": 1e9, "speed": 0.2}, "minutes"),
    ({"id": "00000000", "minutes": 5, "speed": 20}, "speed"),
    ({"id": "00000000", "minutes": 5, "speed": 0.2, "within": [{"left": 1}]}, "within"),
    ({"id": "00000000", "minutes": 5, "speed": 0.2, "force": True}, "force"),
)


async def test_grants_beyond_limits_are_refused(assistant: ConnectedAssistant) -> None:
    for value, problem in BEYOND:
        status, text = await assistant.post("grant", value)
        assert status in (400, 404), value
        assert problem in text


async def test_at_most_four_assistants_are_connected(assistant: ConnectedAssistant) -> None:
    statuses = []
    for _ in range(5):
        _, settings = await assistant.post("connect", {})
        headers = {"Authorization": f"Bearer {settings['secret']}", "Accept": "application/json, text/event-stream"}
        async with assistant.client.post(settings["url"], json={}, headers=headers) as answer:
            statuses.append(answer.status)
    assert statuses == [400, 400, 400, 400, 503]
