"""The web socket of data and its limits. No robot runs."""

import asyncio
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.server.test_application import ApplicationServer  # noqa: E402
from tests.web.server.test_application import server as server  # noqa: E402 - a fixture

from ur.web.access.roles import Role  # noqa: E402


async def answer(socket: Any, number: int) -> Any:
    """The answer with this number."""
    while True:
        message = await socket.receive_json(timeout=30)
        if message["t"] == "answer" and message["id"] == number:
            return message


async def test_request_without_a_robot_is_answered(server: ApplicationServer) -> None:
    await server.log_in(Role.LOOK)
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        beat = await socket.receive_json(timeout=30)
        assert (beat["t"], beat["end"]) == ("beat", "starting")
        await socket.send_json({"t": "model", "id": 9})
        assert "not connected" in (await answer(socket, 9))["text"]


async def test_page_that_floods_is_closed(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        for _ in range(100):
            await socket.send_json({"t": "show"})
        while (await socket.receive(timeout=30)).type is not aiohttp.WSMsgType.CLOSE:
            pass


async def test_malformed_request_is_answered_and_too_many_are_not(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        await socket.send_json({"t": "mesh", "id": 3, "mesh": "no slash"})
        assert "mesh: expected package://" in (await answer(socket, 3))["text"]
        for _ in range(25):
            await socket.send_str("[")
            await asyncio.sleep(0)
        while (await socket.receive(timeout=30)).type is not aiohttp.WSMsgType.CLOSE:
            pass
