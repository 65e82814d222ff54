"""Stored maps over HTTP, with real maps and the real `ur maps`: roles, names, and what changes on the disk."""

import os
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServerClient  # noqa: E402

from ur.maps.picture_file import write_picture  # noqa: E402
from ur.maps.store import MapStore, own_store  # noqa: E402
from ur.maps.waypoint_file import waypoint_path  # noqa: E402
from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.runs.commands import CommandQueue, EndedCommand  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402

BAD_NAMES = (
    "../flat",
    "/etc/passwd",
    "--yes",
    "latest",
    "",
    ".lock",
    "a b",
    "flat/../flat",
    "x" * 65,
    None,
    ["flat"],
    7,
)


class NotedCommands(CommandQueue):
    """Commands of `ur` that are noted as well."""

    def __init__(self, environment: dict[str, str]) -> None:
        super().__init__(environment)
        self.ran: list[tuple[str, ...]] = []

    async def run(self, *words: str, limit: float) -> EndedCommand:
        self.ran.append(words)
        return await super().run(*words, limit=limit)


@dataclass
class MapPagesServer(PageServerClient):
    store: MapStore
    waypoints: Path
    commands: NotedCommands

    async def change(self, what: str, value: object) -> tuple[int, str]:
        return await self.post(f"/api/maps/{what}", value)

    async def list(self) -> Any:
        return await self.read("/api/maps")


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[MapPagesServer]:
    port = free_port()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", lambda _: None)
    own = {"HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path / "data")}
    environment = {**os.environ, **own, "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    store = own_store(environment)
    for name in ("flat", "hall"):
        store.path(name).mkdir(parents=True)
        write_picture(store.path(name) / "map", np.zeros((20, 40), np.int8), 0.1, (0.0, 0.0, 0.0))
    waypoints = waypoint_path("flat", environment)
    waypoints.parent.mkdir(parents=True)
    waypoints.write_text("door: [1, 2, 90]\n", encoding="utf-8")
    commands = NotedCommands(environment)
    application = Application(gate, {}, environment, "bob", lambda _: None, commands=commands)
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        yield MapPagesServer(gate, f"http://127.0.0.1:{port}", client, store, waypoints.parent, commands)


async def test_maps_are_listed_renamed_with_their_places_and_deleted(server: MapPagesServer) -> None:
    await server.log_in(Role.DRIVE)
    flat, hall = await server.list()
    assert (flat["name"], flat["width"], flat["height"], flat["places"]) == ("flat", 4.0, 2.0, 1)
    assert (hall["name"], hall["places"], len(hall["picture"])) == ("hall", 0, 10)
    assert "file" not in flat
    assert await server.change("rename", {"name": "flat", "new_name": "home"}) == (200, '{"ok": true}')
    assert [(each["name"], each["places"]) for each in await server.list()] == [("hall", 0), ("home", 1)]
    assert (server.waypoints / "home.yaml").exists()
    status, text = await server.change("rename", {"name": "home", "new_name": "hall"})
    assert (status, "map 'hall' exists" in text) == (409, True)
    with server.store.claim("home"):
        status, text = await server.change("delete", {"name": "home"})
        assert (status, "in use" in text) == (409, True)
    assert (await server.change("delete", {"name": "home"}))[0] == 200
    assert server.store.names() == ["hall"]
    status, text = await server.change("delete", {"name": "home"})
    assert (status, "unknown map 'home'" in text) == (409, True)


async def test_names_that_no_map_can_have_reach_no_command(server: MapPagesServer) -> None:
    await server.log_in(Role.DRIVE)
    for name in BAD_NAMES:
        assert (await server.change("delete", {"name": name}))[0] == 409, name
        assert (await server.change("rename", {"name": name, "new_name": "home"}))[0] == 409, name
        assert (await server.change("rename", {"name": "flat", "new_name": name}))[0] == 409, name
    values: tuple[object, ...] = ([], "flat", None)
    for value in values:
        assert (await server.change("delete", value))[0] == 400
    assert server.commands.ran == []
    assert server.store.names() == ["flat", "hall"]


async def test_role_that_looks_gets_the_list_without_pictures_and_changes_nothing(server: MapPagesServer) -> None:
    await server.log_in(Role.LOOK)
    assert [(each["name"], each["picture"]) for each in await server.list()] == [("flat", []), ("hall", [])]
    assert (await server.change("rename", {"name": "flat", "new_name": "home"}))[0] == 403
    assert (await server.change("delete", {"name": "flat"}))[0] == 403
    assert server.store.names() == ["flat", "hall"]
