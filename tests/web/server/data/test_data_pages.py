"""The web socket of data: roles, freshness and limits. No robot runs."""

import asyncio
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.server.test_application import ApplicationServer  # noqa: E402
from tests.web.server.test_application import server as server  # noqa: E402 - a fixture

from ur.web.access.roles import Role  # noqa: E402

PUBLISH = {"t": "publish", "topic": "/chatter", "kind": "std_msgs/String", "value": "{}"}


async def answer(socket: Any, number: int) -> Any:
    """The answer with this number."""
    while True:
        message = await socket.receive_json(timeout=30)
        if message["t"] == "answer" and message["id"] == number:
            return message


async def test_role_that_looks_asks_and_changes_nothing(server: ApplicationServer) -> None:
    await server.log_in(Role.LOOK)
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        beat = await socket.receive_json(timeout=30)
        assert (beat["t"], beat["end"]) == ("beat", "starting")
        for number, request in enumerate(
            (
                PUBLISH,
                {"t": "call", "service": "/x", "value": "{}"},
                {"t": "set", "name": "/x", "value": "1"},
            ),
            1,
        ):
            await socket.send_json({**request, "id": number, "n": beat["n"]})
            assert "may look" in (await answer(socket, number))["text"]
        await socket.send_json({"t": "services", "id": 9})
        assert "not connected" in (await answer(socket, 9))["text"]


async def test_request_that_waited_in_a_connection_is_refused(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        await socket.send_json({**PUBLISH, "id": 1, "n": 4000})
        assert "too slow" in (await answer(socket, 1))["text"]


async def test_page_that_changes_too_much_is_refused_and_one_that_floods_is_closed(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        beat = (await socket.receive_json(timeout=30))["n"]
        for number in range(1, 21):
            await socket.send_json({**PUBLISH, "id": number, "n": beat})
        texts = [(await answer(socket, number))["text"] for number in range(1, 21)]
        assert any("too many requests" in text for text in texts)
        assert any("not connected" in text for text in texts)
        for _ in range(100):
            await socket.send_json({"t": "show"})
        while (await socket.receive(timeout=30)).type is not aiohttp.WSMsgType.CLOSE:
            pass


async def test_malformed_request_is_answered_and_too_many_are_not(server: ApplicationServer) -> None:
    await server.log_in()
    async with server.client.ws_connect(f"{server.url}/ws/data", headers=server.origin) as socket:
        await socket.send_json({"t": "publish", "id": 3, "n": 1, "topic": "no slash", "kind": "a/B", "value": "{}"})
        assert "topic: expected a full name" in (await answer(socket, 3))["text"]
        for _ in range(25):
            await socket.send_str("[")
            await asyncio.sleep(0)
        while (await socket.receive(timeout=30)).type is not aiohttp.WSMsgType.CLOSE:
            pass
