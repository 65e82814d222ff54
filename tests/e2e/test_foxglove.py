"""Viewers of other makers on `ur web --foxglove`, with the real simulator; what is left when the server is killed."""

import asyncio
import contextlib
import json
import re
import signal
import struct
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.e2e.camera_publisher import PICTURE
from tests.e2e.conftest import PYTHON, ROOT, LaunchedRobot, end, is_alive, list_family
from tests.ros_session import free_port

aiohttp = pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")
pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: requirements/foxglove.lock")

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]
SDK, OLD = "foxglove.sdk.v1", "foxglove.websocket.v1"
LIMIT = 60.0  # s


class FoxgloveViewer:
    """A client of the Foxglove WebSocket protocol."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.channels: dict[str, Any] = {}
        self.info: Any = None
        self.messages: dict[int, list[bytes]] = {}
        self.status: list[str] = []

    async def until(self, condition: Callable[[], object], limit: float = LIMIT) -> None:
        """Read messages until a condition holds; TimeoutError when it does not within the limit (s)."""
        deadline = time.monotonic() + limit
        while not condition():
            left = deadline - time.monotonic()
            if left <= 0:
                raise asyncio.TimeoutError(self.status)
            message = await self.socket.receive(timeout=left)
            if message.type is aiohttp.WSMsgType.BINARY:
                kind, number, _ = struct.unpack_from("<BIQ", message.data)
                assert kind == 1
                self.messages.setdefault(number, []).append(message.data[13:])
                continue
            assert message.type is aiohttp.WSMsgType.TEXT, (message, self.status)
            value = json.loads(message.data)
            if value["op"] == "serverInfo":
                self.info = value
            elif value["op"] == "advertise":
                self.channels.update((each["topic"], each) for each in value["channels"])
            elif value["op"] == "status":
                self.status.append(value["message"])

    async def subscribe(self, number: int, topic: str) -> bytes:
        """Subscribe, and return the first message."""
        await self.ask_for(number, topic)
        await self.until(lambda: self.messages.get(number))
        return self.messages[number][0]

    async def ask_for(self, number: int, topic: str) -> None:
        """Subscribe."""
        await self.until(lambda: topic in self.channels)
        wanted = [{"id": number, "channelId": self.channels[topic]["id"]}]
        await self.socket.send_json({"op": "subscribe", "subscriptions": wanted})

    async def publish(self, number: int, topic: str, schema: str, data: bytes) -> None:
        channel = {"id": number, "topic": topic, "encoding": "ros1", "schemaName": schema}
        await self.socket.send_json({"op": "advertise", "channels": [channel]})
        await self.socket.send_bytes(struct.pack("<BI", 1, number) + data)


def pose_bytes(x: float, y: float, frame: str = "map") -> bytes:
    """A geometry_msgs/PoseStamped."""
    head = struct.pack("<4I", 0, 0, 0, len(frame)) + frame.encode()
    return head + struct.pack("<7d", x, y, 0.0, 0.0, 0.0, 0.0, 1.0)


@dataclass
class PageProcess:
    process: subprocess.Popen[Any]
    printed: str
    port: int

    @property
    def address(self) -> str:
        found = re.search(r"ws://\S+", self.printed)
        assert found
        return found[0].replace("ws:", "http:")


def start_server(robot: LaunchedRobot, *options: str) -> PageProcess:
    port = free_port()
    log = robot.log.with_name(f"web-{port}.log")
    command = [str(ROOT / "ur"), "web", "--port", str(port), "--no-browser", "--foxglove", *options]
    with log.open("w") as output:
        process = subprocess.Popen(
            command, env=robot.env, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd=ROOT
        )
    deadline = time.monotonic() + LIMIT
    while "ws://" not in log.read_text():
        assert process.poll() is None, log.read_text()
        assert time.monotonic() < deadline, "ur web printed no address"
        time.sleep(0.1)
    return PageProcess(process, log.read_text(), port)


@pytest.fixture(scope="module")
def server(robot: LaunchedRobot) -> Iterator[PageProcess]:
    server = start_server(robot)
    yield server
    end(server.process)


@pytest.fixture(scope="module")
def camera(robot: LaunchedRobot) -> Iterator[None]:
    command = [str(PYTHON), "-m", "tests.e2e.camera_publisher"]
    process = subprocess.Popen(command, cwd=ROOT, env=robot.env, stdin=subprocess.DEVNULL)
    yield
    end(process)


async def refusal(client: Any, address: str, **headers: str) -> int:
    """The HTTP status with which a viewer is refused; 101 for one that is not."""
    try:
        async with client.ws_connect(address, protocols=(OLD, SDK), headers=headers):
            return 101
    except aiohttp.WSServerHandshakeError as problem:
        return int(problem.status)


async def wait_until_up(client: Any, address: str) -> None:
    deadline = time.monotonic() + LIMIT
    while (status := await refusal(client, address)) != 101:
        assert status == 503, status
        assert time.monotonic() < deadline, "the robot's end is not up"
        await asyncio.sleep(0.2)


@pytest.mark.usefixtures("camera")
async def test_viewer_sees_scan_map_and_camera_and_sends_a_goal(server: PageProcess, robot: LaunchedRobot) -> None:
    async with aiohttp.ClientSession() as client:
        await wait_until_up(client, server.address)
        bare = server.address.partition("?")[0]
        assert await refusal(client, bare) == 403
        assert await refusal(client, f"{bare}?token=wrong") == 403
        assert await refusal(client, server.address, Origin="http://evil.example") == 403
        assert await refusal(client, server.address, Host="evil.example") == 421
        async with client.ws_connect(server.address, protocols=(OLD,), max_msg_size=0) as socket:
            assert socket.protocol == OLD
            viewer = FoxgloveViewer(socket)
            scan = await viewer.subscribe(1, "/scan")
            grid = await viewer.subscribe(2, "/map")
            picture = await viewer.subscribe(3, "/raspicam_node/image/compressed")
            assert viewer.info["capabilities"] == ["clientPublish"]
            assert viewer.info["metadata"]["ROS_DISTRO"] == "noetic"
            for topic, schema in (("/scan", "sensor_msgs/LaserScan"), ("/map", "nav_msgs/OccupancyGrid")):
                channel = viewer.channels[topic]
                assert (channel["encoding"], channel["schemaEncoding"]) == ("ros1", "ros1msg")
                assert channel["schemaName"] == schema
                assert "MSG: std_msgs/Header" in channel["schema"]
            assert struct.unpack_from("<I", scan, 12)[0] == len(scan[16:].partition(b"\x00")[0]) or b"laser" in scan
            assert b"map" in grid[:40]
            assert picture.endswith(struct.pack("<I", len(PICTURE)) + PICTURE)  # not a byte of it was touched
            async with client.ws_connect(server.address, protocols=(SDK,), max_msg_size=0) as other:
                second = FoxgloveViewer(other)
                assert (await second.subscribe(7, "/map"))[16:] == grid[16:]  # latched, though long published
            await viewer.publish(11, "/cmd_vel", "geometry_msgs/Twist", bytes(48))
            await viewer.until(lambda: any("/cmd_vel is not taken" in each for each in viewer.status))
            await viewer.publish(12, "/move_base_simple/goal", "geometry_msgs/PoseStamped", pose_bytes(1, 0, "odom"))
            await viewer.until(lambda: any("expected one in 'map'" in each for each in viewer.status))
            await viewer.ask_for(4, "/move_base/current_goal")
            for _ in range(12):  # it comes once for each goal, and nothing says when the subscription is there
                await viewer.publish(12, "/move_base_simple/goal", "geometry_msgs/PoseStamped", pose_bytes(1.0, 0.0))
                with contextlib.suppress(asyncio.TimeoutError):
                    await viewer.until(lambda: viewer.messages.get(4), 5.0)
                    break
            assert viewer.messages.get(4), viewer.status
            await asyncio.to_thread(robot.ask, "moving", seconds=150)
            await asyncio.to_thread(robot.ask, "lease", state="held", seconds=150)
            for _ in range(15):
                await viewer.publish(12, "/move_base_simple/goal", "geometry_msgs/PoseStamped", pose_bytes(1.0, 0.0))
            await viewer.until(lambda: any("too many at once, expected at most 2 a second" in e for e in viewer.status))
            await socket.close()
        await asyncio.to_thread(robot.ask, "still", seconds=150)  # nobody can continue its goal: it is cancelled
        await asyncio.to_thread(robot.ask, "lease", state="free", seconds=150)


async def test_viewer_that_may_only_look_cannot_publish(robot: LaunchedRobot) -> None:
    server = start_server(robot, "--look")
    try:
        async with aiohttp.ClientSession() as client:
            await wait_until_up(client, server.address)
            async with client.ws_connect(server.address, protocols=(SDK,), max_msg_size=0) as socket:
                viewer = FoxgloveViewer(socket)
                await viewer.subscribe(1, "/scan")
                assert viewer.info["capabilities"] == []
                await viewer.publish(2, "/move_base_simple/goal", "geometry_msgs/PoseStamped", pose_bytes(0.0, 0.0))
                await viewer.until(lambda: any("may look" in each for each in viewer.status))
        log = next(Path(robot.env["HOME"]).rglob("web.log")).read_text()
        assert not re.search(r"token=", log)
    finally:
        end(server.process)


async def test_killed_server_leaves_the_base_at_rest_and_no_process(robot: LaunchedRobot) -> None:
    others = {*filter(is_robot_end, list_family(robot.launch.pid))}
    server = start_server(robot)
    try:
        url = f"http://localhost:{server.port}"
        token = re.search(r"login#(\S+)", server.printed)
        assert token
        async with aiohttp.ClientSession(headers={"Origin": url}) as client:
            await wait_until_up(client, server.address)
            await (await client.post(f"{url}/login", json={"token": token[1]})).release()
            async with client.ws_connect(server.address, protocols=(SDK,), max_msg_size=0) as viewer:
                await FoxgloveViewer(viewer).subscribe(1, "/scan")
                async with client.ws_connect(f"{url}/ws/drive?tab=0123456789") as page:
                    driving = asyncio.create_task(hold_stick(page))
                    await asyncio.to_thread(robot.ask, "moving", seconds=150)
                    ends = {*filter(is_robot_end, list_family(robot.launch.pid))} - others
                    family = [each for each in {*list_family(server.process.pid), *ends} if is_alive(each)]
                    assert len(family) >= 3  # the server, the robot's end, which the run may have forked, and viewers'
                    server.process.send_signal(signal.SIGKILL)
                    server.process.wait(30)
                    await asyncio.to_thread(robot.ask, "still", seconds=150)
                    with contextlib.suppress(aiohttp.ClientConnectionResetError):  # it was sending just then
                        await driving
    finally:
        server.process.kill()
        server.process.wait(30)
    deadline = time.monotonic() + LIMIT
    while left := [each for each in family if is_alive(each)]:
        assert time.monotonic() < deadline, [psutil.Process(each).cmdline() for each in left]
        await asyncio.sleep(0.1)


def is_robot_end(pid: int) -> bool:
    """Whether a process is the page's node."""
    return any("robot_endpoint" in word for word in psutil.Process(pid).cmdline())


async def hold_stick(page: Any) -> None:
    """Answer every challenge with a command, until the server is gone; after a refusal with a new press."""
    hold, taken = 1, False
    async for message in page:
        value = json.loads(message.data)
        hold += value.get("t") == "over"
        if "n" in value:
            if not taken:  # a viewer has driven before
                taken = True
                await page.send_json({"t": "lease", "n": value["n"], "do": "take"})
            await page.send_json({"t": "stick", "n": value["n"], "hold": hold, "forward": 0.2, "turn": 0.0})
