"""Servers of two robots: one started by the other, with a real master each."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, closing
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from tests.ros_session import RosSession, free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.fakes.page_server import read_answer  # noqa: E402

from ur.robot.discovery.masters import RobotMaster  # noqa: E402
from ur.web.access.origin import make_origins  # noqa: E402
from ur.web.access.roles import Role  # noqa: E402
from ur.web.server.application import Application  # noqa: E402
from ur.web.server.connections.http_server import open_server  # noqa: E402
from ur.web.server.connections.listener import listen  # noqa: E402
from ur.web.server.logins.gate import LoginGate  # noqa: E402
from ur.web.server.robots import robot_servers  # noqa: E402
from ur.web.server.robots.peer import PeerError  # noqa: E402
from ur.web.server.robots.robot_servers import RobotServers  # noqa: E402
from ur.web.server.robots.robots import ServerLogin  # noqa: E402

pytestmark = pytest.mark.skipif(not Path("/usr/bin/rosmaster").exists(), reason="no rosmaster")


def make_home(folder: Path) -> dict[str, str]:
    """An environment whose user has set up the robot bob."""
    robots = folder / ".config/ubiquity_launches/robots"
    robots.mkdir(parents=True)
    (robots / "bob.yaml").write_text('name: "bob"\nuser: "ros"\nbase: "magni"\n')
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG", "ROS", "UR_"))}
    return kept | {"HOME": str(folder), "ROS_HOSTNAME": "localhost"}


class VisitedPage:
    """A browser on the page of a server, logged in by a link."""

    def __init__(self, client: Any, link: str) -> None:
        address = urlsplit(link)
        self.client, self.url, self.token = client, f"http://{address.netloc}", address.fragment

    async def log_in(self) -> dict[str, Any]:
        origin = {"Origin": self.url}
        async with self.client.post(f"{self.url}/login", json={"token": self.token}, headers=origin) as answer:
            assert answer.status == 200
        return dict(await self.get("/api/me"))

    async def get(self, path: str) -> Any:
        return await read_answer(self.client, self.url + path)

    async def open(self, name: str) -> VisitedPage:
        origin = {"Origin": self.url}
        async with self.client.post(f"{self.url}/api/robots", json={"name": name}, headers=origin) as answer:
            assert answer.status == 200, await answer.text()
            return VisitedPage(self.client, (await answer.json())["link"])

    async def list(self) -> dict[str, tuple[bool, bool]]:
        return {each["name"]: (each["answers"], each["shown"]) for each in await self.get("/api/robots")}


@pytest.fixture
async def client() -> AsyncIterator[Any]:
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client:
        yield client


async def test_page_changes_to_another_robot_with_its_role_and_back(client: Any, tmp_path: Path) -> None:
    environment, log = make_home(tmp_path), list[str]()
    with closing(RosSession(tmp_path / "a")) as first, closing(RosSession(tmp_path / "b")) as second:
        environment["ROS_MASTER_URI"] = first.env["ROS_MASTER_URI"]
        known = (
            RobotMaster("sim", "sim", first.env["ROS_MASTER_URI"]),
            RobotMaster("bob", "bob", second.env["ROS_MASTER_URI"]),
            RobotMaster("carla", "carla", f"http://localhost:{free_port()}"),
        )
        port = free_port()
        gate = LoginGate(make_origins((), port), tmp_path / "sessions.json", log.append)
        robots = RobotServers(
            "sim", lambda: known, lambda role: ServerLogin(port, gate.invite(role)), (), environment, log.append
        )
        application = Application(gate, {}, environment, "simulated robot", log.append, robots)
        async with open_server(application.build(), gate, listen("127.0.0.1", port), log.append):
            for role in (Role.LOOK, Role.DRIVE):
                sim = VisitedPage(client, f"http://127.0.0.1:{port}/login#{gate.invite(role)}")
                assert (await sim.log_in())["role"] == role.value
                assert await sim.list() == {"sim": (True, True), "bob": (True, False), "carla": (False, False)}
                bob = await sim.open("bob")
                me = await bob.log_in()
                assert (me["role"], me["robot"]) == (role.value, "bob")
                async with client.ws_connect(f"{bob.url}/ws/view?layers=", headers={"Origin": bob.url}) as view:
                    # States of the robot may come before the one of the server.
                    while second.env["ROS_MASTER_URI"] not in str((await view.receive(timeout=60)).data):
                        assert not view.closed
                assert await bob.list() == {"sim": (True, False), "bob": (True, True), "carla": (False, False)}
                back = await bob.open("sim")
                assert back.url == sim.url
                assert (await back.log_in())["role"] == role.value
                assert len(robots._servers) == 1  # the second role has not started another one
            process = robots._servers["bob"]._process
            (end,) = _children(process.pid, b"robot_endpoint_node")
            assert b"UR_ROBOT=bob" in Path(f"/proc/{end}/environ").read_bytes().split(b"\0")
            with pytest.raises(PeerError, match="not in the list"):
                await robots.invite("eve", Role.DRIVE)
            with pytest.MonkeyPatch().context() as patch:
                patch.setattr(robot_servers, "MOST", 1)
                with pytest.raises(PeerError, match="other robots are open"):
                    await robots.invite("carla", Role.LOOK)
        assert process.returncode == 0
        assert not robots._servers
    assert not any(each in line for line in log for each in (sim.token, bob.token, back.token))
    state = tmp_path / ".local/state/ubiquity_launches/web"
    assert bob.token not in (state / "web.log").read_text()
    assert not list(state.glob("sessions-*.json"))


async def test_server_that_does_not_start_is_reported_with_its_error(tmp_path: Path) -> None:
    environment, log = make_home(tmp_path), list[str]()
    known = (RobotMaster("sim", "sim:nosuchbase", f"http://localhost:{free_port()}"),)
    robots = RobotServers("bob", lambda: known, lambda _: ServerLogin(1, ""), (), environment, log.append)
    with pytest.raises(PeerError, match="nosuchbase"):
        await robots.invite("sim", Role.LOOK)
    await robots.close()


async def test_server_ends_with_the_one_that_started_it_also_when_that_is_killed(client: Any, tmp_path: Path) -> None:
    environment = make_home(tmp_path) | {"ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    command = [sys.executable, "-I", "-m", "ur", "web", "sim", "--no-browser", "--port", str(free_port())]
    async with AsyncExitStack() as stack:
        parent = subprocess.Popen(command, env=environment, stdin=-3, stdout=-1, stderr=-2, text=True)
        stack.callback(parent.wait)
        stack.callback(parent.kill)
        assert parent.stdout is not None
        stack.callback(parent.stdout.close)
        found = re.search(r"open (\S+)", parent.stdout.readline())
        assert found
        sim = VisitedPage(client, found[1])
        await sim.log_in()
        assert {"sim", "bob"} <= (await sim.list()).keys()
        bob = await sim.open("bob")
        assert (await bob.log_in())["robot"] == "bob"
        (child,) = _children(parent.pid)
        arguments = Path(f"/proc/{child}/cmdline").read_text().split("\0")
        assert arguments[4:6] == ["web", "bob"]
        assert not any(bob.token in each for each in arguments)
        parent.send_signal(signal.SIGKILL)
        deadline = time.monotonic() + 60
        while _is_running(child):
            assert time.monotonic() < deadline
            await asyncio.sleep(0.05)


def _children(pid: int, mark: bytes = b"--child") -> list[int]:
    """The processes that a process has started with a text in their command line: servers unless given."""
    found = [
        int(each) for task in Path(f"/proc/{pid}/task").iterdir() for each in (task / "children").read_text().split()
    ]
    return [each for each in found if mark in Path(f"/proc/{each}/cmdline").read_bytes()]


def _is_running(pid: int) -> bool:
    try:
        return bool(Path(f"/proc/{pid}/cmdline").read_bytes())  # empty for one that has ended and is not waited for
    except OSError:
        return False
