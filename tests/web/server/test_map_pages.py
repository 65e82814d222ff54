"""Stored maps over HTTP, with real maps and the real `ur maps`."""

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

from ur.maps.names import waypoint_path  # noqa: E402
from ur.maps.picture_file import write_picture  # noqa: E402
from ur.maps.store import own_store  # noqa: E402
from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402


@dataclass
class MapPagesServer(PageServerClient):
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
    application = Application(gate, {}, environment, "bob", lambda _: None)
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        yield MapPagesServer(gate, f"http://127.0.0.1:{port}", client)


async def test_maps_are_listed_with_their_places(server: MapPagesServer) -> None:
    await server.log_in(Role.DRIVE)
    flat, hall = await server.list()
    assert (flat["name"], flat["width"], flat["height"], flat["places"]) == ("flat", 4.0, 2.0, 1)
    assert (hall["name"], hall["places"], len(hall["picture"])) == ("hall", 0, 10)
    assert "file" not in flat


async def test_role_that_looks_gets_the_list_without_pictures(server: MapPagesServer) -> None:
    await server.log_in(Role.LOOK)
    assert [(each["name"], each["picture"]) for each in await server.list()] == [("flat", []), ("hall", [])]
