"""Grants to assistants on the page: a login that may drive gives them within limits, and any takes them back."""

import json
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

import aiohttp
from tests.fakes.page_server import PageServerClient
from tests.ros_session import free_port
from tests.web.server.robot_processes import IdleRobotEnd, keep

from ur.mcp.assistant import ActionLog
from ur.mcp.grants import GrantFiles, Request, ServerRecord
from ur.web.access.origin import make_origins
from ur.web.access.roles import Role
from ur.web.server.application import Application
from ur.web.server.assistant_pages import AssistantPages
from ur.web.server.connections.http_server import open_server
from ur.web.server.connections.listener import listen
from ur.web.server.logins.gate import LoginGate

ID = "0123abcd"


class AssistantPage(PageServerClient):
    """A page that may drive, beside an assistant that asks to."""

    files: GrantFiles
    pages: AssistantPages

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


@pytest.fixture
async def page(tmp_path: Path) -> AsyncIterator[AssistantPage]:
    port, ends, environment = free_port(), list[Any](), {"ROS_MASTER_URI": "http://localhost:1"}
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", lambda _: None)
    pages = AssistantPages(environment, lambda _: None, GrantFiles(tmp_path / "mcp"))
    application = Application(
        gate, {}, environment, "bob", lambda _: None, make_robot_process=keep(ends, IdleRobotEnd), assistants=pages
    )
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        found = AssistantPage(gate, f"http://127.0.0.1:{port}", client)
        found.files, found.pages = GrantFiles(tmp_path / "mcp"), pages
        found.files.note_server(ID, ServerRecord(os.getpid(), "Ada's helper", Request(5.0, 0.3, "to look at the door")))
        await found.log_in(Role.DRIVE)
        yield found


async def test_page_gives_the_grant_that_an_assistant_asks_for_and_takes_it_back(page: AssistantPage) -> None:
    asking = page.find()
    assert (asking["name"], asking["asks"]["reason"], asking["grant"]) == ("Ada's helper", "to look at the door", None)
    kitchen = {"left": 4.0, "bottom": 1.0, "right": 2.0, "top": -1.0, "name": "kitchen"}
    status, answer = await page.post("grant", {"id": ID, "minutes": 5.0, "speed": 0.2, "avoid": [kitchen]})
    assert status == 200, answer
    assert answer["text"].endswith(", not kitchen")
    assert page.find()["asks"] is None
    grant = page.files.find(ID)
    assert grant is not None
    assert (grant.speed, grant.avoid[0].left, grant.programs) == (0.2, 2.0, False)
    assert (await page.post("end", {"id": ID}))[0] == 200
    assert page.find()["grant"] is None
    actions = [json.loads(line) for line in ActionLog(page.files.log).read()]
    assert "lets Ada's helper drive" in actions[0]["result"]
    assert "does not let Ada's helper drive any more" in actions[1]["result"]


BEYOND: tuple[tuple[dict[str, Any], str], ...] = (
    ({"id": "zz", "minutes": 5, "speed": 0.2}, "id"),
    ({"id": "00000000", "minutes": 5, "speed": 0.2}, "has ended"),
    ({"id": ID, "minutes": 1e9, "speed": 0.2}, "minutes"),
    ({"id": ID, "minutes": 5, "speed": 20}, "speed"),
    ({"id": ID, "minutes": 5, "speed": 0.2, "within": [{"left": 1}]}, "within"),
    ({"id": ID, "minutes": 5, "speed": 0.2, "force": True}, "force"),
)


async def test_grants_beyond_limits_are_refused(page: AssistantPage) -> None:
    for value, problem in BEYOND:
        status, text = await page.post("grant", value)
        assert status in (400, 404), value
        assert problem in text
        assert page.find()["grant"] is None
