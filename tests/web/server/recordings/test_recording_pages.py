"""Recordings over HTTP: roles, ids, download and removal. No robot runs."""

import asyncio
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.recordings.fake_replay import fake_replay
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import PageServerClient  # noqa: E402

from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.recordings.recording_pages import PublishedTopic, RecordingPages, list_topics  # noqa: E402
from ur.web.server.recordings.store import recordings_folder  # noqa: E402

NAME = "recording_2026-03-01_14-05-31_001.mcap"
BYTES = b"\x89MCAP0\r\n" + bytes(300_000)
SCRIPT = 'trap "mv $0.mcap.part $0.mcap; exit" INT; echo $@ > $0.mcap.part; while :; do sleep 0.05; done'


def make_command(_: Mapping[str, str], folder: Path, topics: Sequence[str]) -> list[str]:
    return ["/bin/sh", "-c", SCRIPT, f"{folder}/recording_2026-03-01_15-00-00_001", *topics]


@dataclass
class RecordingServer(PageServerClient):
    folder: Path
    topics: list[PublishedTopic]

    async def change(self, what: str, value: object) -> tuple[int, str]:
        return await self.post(f"/api/recordings/{what}", value)

    async def state(self) -> Any:
        return await self.read("/api/recordings")


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[RecordingServer]:
    port = free_port()
    gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", lambda _: None)
    environment = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    folder = recordings_folder(environment)
    folder.mkdir(parents=True)
    (folder / NAME).write_bytes(BYTES)
    topics: list[PublishedTopic] = []
    recordings = RecordingPages(
        environment,
        lambda _: None,
        None,
        make_command,
        lambda master: tuple(topics) or list_topics(master),
    )
    application = Application(gate, {}, environment, "bob", lambda _: None, recordings=recordings)
    async with (
        open_server(application.build(), gate, listen("127.0.0.1", port), lambda _: None),
        aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client,
    ):
        yield RecordingServer(gate, f"http://127.0.0.1:{port}", client, folder, topics)


async def test_file_is_downloaded_as_an_attachment(server: RecordingServer) -> None:
    await server.log_in(Role.DRIVE)
    async with server.client.get(f"{server.url}/api/recordings/file?id={NAME}") as answer:
        assert answer.status == 200
        assert answer.headers["Content-Disposition"] == f'attachment; filename="{NAME}"'
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers["Content-Type"] == "application/octet-stream"
        assert answer.headers["Cache-Control"] == "no-store"
        assert await answer.read() == BYTES


async def test_only_listed_files_are_downloaded_and_deleted(server: RecordingServer) -> None:
    await server.log_in(Role.DRIVE)
    secret = server.folder.parent / "sessions.json"
    secret.write_text("secret")
    for name in ("../sessions.json", "..%2Fsessions.json", "%2Fetc%2Fpasswd", "lock", "", f"{NAME}%00", f".%2F{NAME}"):
        async with server.client.get(f"{server.url}/api/recordings/file?id={name}") as answer:
            assert answer.status == 404, name
    for each in ("../sessions.json", str(secret), None, [NAME], {"id": NAME}, 1):
        assert (await server.change("delete", {"id": each}))[0] == 404, each
    assert secret.read_text() == "secret"
    assert (await server.change("delete", {"id": NAME}))[0] == 200
    assert not (server.folder / NAME).exists()
    assert (await server.change("delete", {"id": NAME}))[0] == 404


async def test_role_that_looks_sees_that_it_records_and_no_files(server: RecordingServer) -> None:
    await server.log_in(Role.LOOK)
    assert await server.state() == {"running": None, "end": ""}
    for what in ("start", "stop", "delete"):
        assert (await server.change(what, {"id": NAME, "topics": ["/scan"]}))[0] == 403
    for what in ("topics", f"file?id={NAME}"):
        async with server.client.get(f"{server.url}/api/recordings/{what}") as answer:
            assert answer.status == 403
    assert (server.folder / NAME).exists()


async def test_recording_without_a_robot_and_with_bad_topics_is_refused(server: RecordingServer) -> None:
    await server.log_in(Role.DRIVE)
    assert await server.change("start", {}) == (409, "the robot is not connected: start a program of it\n")
    for topics in (["--all"], ["/a b"], [], "/scan", ["/scan", "-O/tmp/x"]):
        status, text = await server.change("start", {"topics": topics})
        assert (status, "full names" in text) == (400, True)
    assert await server.change("stop", {}) == (409, "nothing is recorded\n")
    assert (await server.change("start", ["topics"]))[0] == 400


async def test_page_starts_and_stops_a_recording(server: RecordingServer) -> None:
    server.topics.append(PublishedTopic("/scan", "sensor_msgs/LaserScan"))
    await server.log_in(Role.DRIVE)
    assert (await server.change("start", {"topics": ["/scan"]}))[0] == 200
    assert (await server.change("start", {}))[0] == 409
    while not (state := await server.state())["running"]["size"]:
        await asyncio.sleep(0.05)
    assert state["running"]["topics"] == 1
    assert [each["name"] for each in state["files"]] == [NAME]
    assert (await server.change("stop", {}))[0] == 200
    state = await server.state()
    assert (state["running"], state["end"].startswith("stopped by")) == (None, True)
    assert len(state["files"]) == 2
    made = server.folder / state["files"][0]["name"]
    assert made.read_text() == "/scan\n"


async def test_replay_that_runs_is_shown_and_controlled_by_who_may_drive(server: RecordingServer) -> None:
    await server.log_in(Role.LOOK)
    assert await server.read("/api/replay") is None
    with fake_replay(server.folder.parents[2]) as replay:
        assert (await server.read("/api/replay"))["position"] == 3.0
        assert (await server.post("/api/replay", {"name": "pause"}))[0] == 403
        await server.log_in(Role.DRIVE)
        assert (await server.post("/api/replay", {"name": "jump", "value": 95.0}))[0] == 200
        assert (await server.post("/api/replay", {"name": "rewind"}))[0] == 400
        assert replay.commands == [("jump", 95.0)]
