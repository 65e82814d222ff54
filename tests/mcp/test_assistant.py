"""An assistant looks at a robot and drives it on the terms of a grant, by the SDK's client, on a bus."""

import asyncio
import base64
import json
import math
import os
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("mcp")

from mcp.client import Client
from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp_types.version import HANDSHAKE_PROTOCOL_VERSIONS, MODERN_PROTOCOL_VERSIONS
from tests.mcp.robot import AssistedRobot, text_of
from tests.ros_session import ROOT

from ur.mcp.assistant import MARK
from ur.mcp.calls import TOOLS
from ur.mcp.grants import Area, DriveGrant
from ur_nodes.client.mux import MuxLink
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import Identity
from ur_nodes.ports.node import Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AssistedRobot:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return AssistedRobot(tmp_path)


async def test_tools_and_resources_are_listed_with_their_limits(robot: AssistedRobot) -> None:
    async with robot.connect() as client:
        tools = (await client.list_tools()).tools
        assert {each.name for each in tools} == set(TOOLS)
        speed = next(each for each in tools if each.name == "drive").input_schema["properties"]["speed"]
        assert (speed["minimum"], speed["maximum"]) == (-2.0, 2.0)
        uris = {str(each.uri) for each in (await client.list_resources()).resources}
        assert {"robot://pose", "robot://map", "docs://docs/how-to/drive-safely"} <= uris


async def test_looking_needs_no_grant_and_is_marked_as_data(robot: AssistedRobot) -> None:
    async with robot.connect() as client:
        text = text_of(await client.call_tool("look", {}))
        assert text.startswith(MARK)
        values = json.loads(text.splitlines()[2])
        assert values["pose"][:2] == pytest.approx([0.0, 0.0], abs=0.3)
        assert values["grant"] is None
        picture = (await client.read_resource("robot://map")).contents[0]
        assert base64.b64decode(picture.blob).startswith(b"\x89PNG")  # type: ignore[union-attr]
        scale = json.loads((await client.read_resource("robot://map/scale")).contents[0].text)  # type: ignore[union-attr]
        assert scale["resolution"] > 0.0
        page = (await client.read_resource("docs://docs/how-to/drive-safely")).contents[0]
        assert "Emergency stop" in page.text  # type: ignore[union-attr]


async def test_driving_without_a_grant_is_refused(robot: AssistedRobot) -> None:
    async with robot.connect() as client:
        for name, arguments in (("drive", {"speed": 0.2}), ("go_to", {"x": 0.5, "y": 0.0})):
            result = await client.call_tool(name, arguments)
            assert result.is_error
            assert "no grant is in force" in text_of(result)
        assert "ur mcp grant" in text_of(await client.call_tool("ask_to_drive", {"reason": "to look at the door"}))
        (server,) = robot.files.list_servers().values()
        assert server.asks is not None
        assert server.asks.reason == "to look at the door"
    assert max(speed for _, speed, *_ in robot.samples) < 0.01


async def test_robot_drives_to_a_place_within_the_speed_of_the_grant_and_is_at_rest_then(robot: AssistedRobot) -> None:
    robot.grant(speed=0.15)
    screen = LeaseClient(robot.stage.bus.node("screen"), "cmd_vel_mux", identity=Identity("s", "desk", "", "watch"))
    seen: set[str] = set()
    robot.stage.client.every(0.1, lambda: seen.add(screen.view().program))
    async with robot.connect() as client:
        result = await client.call_tool("go_to", {"x": 0.5, "y": 0.0})
        assert not result.is_error, text_of(result)
        assert "reached" in text_of(result)
        lines = robot.assistant.log.read()
        assert json.loads(lines[-1])["action"] == "go_to"
    for _ in range(40):
        robot.step()
    assert 0.1 < max(speed for _, speed, *_ in robot.samples) <= 0.15 + 0.02
    assert robot.samples[-1][1] < 0.01
    assert any(each.startswith("assistant, at most 0.15 m/s until ") for each in seen)
    assert screen.view().state == "free"


@pytest.mark.parametrize(("late", "answer"), [(1.0, "driven"), (60.0, "the pose of the robot is not known")])
async def test_motion_begins_when_the_pose_of_the_robot_is_known(
    robot: AssistedRobot, late: float, answer: str
) -> None:
    robot.grant()
    robot.lost.add("/tf")
    robot.step(0.6)  # the last pose is older than a motion needs
    known = robot.now + late

    async def find_pose() -> None:
        while robot.now < known:
            await asyncio.sleep(0)
        robot.lost.clear()

    finder = asyncio.create_task(find_pose())
    async with robot.connect() as client:
        assert answer in text_of(await client.call_tool("drive", {"speed": 0.2, "seconds": 1.0}))
    finder.cancel()
    assert max((speed for at, speed, *_ in robot.samples if at < known), default=0.0) < 0.01


async def test_robot_stays_in_the_area_of_the_grant(robot: AssistedRobot) -> None:
    robot.grant(within=(Area(-0.5, -0.5, 0.4, 0.5),), avoid=(Area(2.0, -1.0, 4.0, 1.0, "kitchen"),))
    async with robot.connect() as client:
        assert "outside of the area" in text_of(await client.call_tool("go_to", {"x": 1.0, "y": 0.0}))
        result = await client.call_tool("drive", {"speed": 0.2, "seconds": 5.0})
        assert "border of the area" in text_of(result)
    for _ in range(40):
        robot.step()
    assert max(x for *_, x, _ in robot.samples) < 0.4
    assert robot.samples[-1][1] < 0.01


@pytest.mark.parametrize("call", [("drive", {"speed": 0.2, "seconds": 5.0}), ("go_to", {"x": 0.9, "y": 0.0})])
async def test_robot_is_at_rest_soon_after_the_assistant_falls_silent(
    robot: AssistedRobot, call: tuple[str, dict[str, float]]
) -> None:
    robot.grant(speed=0.3)
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool(*call))
        silent_at = await wait_for_motion(robot)
        robot.link.silent = True
        while robot.now < silent_at + 1.5:
            await asyncio.sleep(0)
        assert "silent" in text_of(await task)
    assert max(speed for at, speed, *_ in robot.samples if at >= silent_at + 0.3) < 0.01


async def test_call_that_is_cancelled_stops_the_robot(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3)
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool("go_to", {"x": 0.9, "y": 0.0}))
        cancelled_at = await wait_for_motion(robot)
        task.cancel()
        while robot.now < cancelled_at + 0.6:
            await asyncio.sleep(0)
    assert max(speed for at, speed, *_ in robot.samples if at >= cancelled_at + 0.35) < 0.01


async def test_grant_that_is_taken_back_stops_the_robot(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3)
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool("go_to", {"x": 0.9, "y": 0.0}))
        await wait_for_motion(robot)
        assert robot.files.revoke(robot.assistant.id)
        assert "no grant" in text_of(await task)


async def test_no_sign_of_life_follows_the_end_of_a_grant(robot: AssistedRobot) -> None:
    async with robot.connect() as client:
        for each in range(4):
            robot.grant(speed=0.3)
            task = asyncio.create_task(client.call_tool("drive", {"speed": 0.1, "turn": 0.3, "seconds": 5.0}))
            began = await wait_for_motion(robot)
            while robot.now < began + 0.01 * each:
                await asyncio.sleep(0)
            robot.files.revoke(robot.assistant.id)
            beats = robot.link.beats
            assert "no grant" in text_of(await task)
            assert robot.link.beats == beats


async def test_person_who_takes_over_ends_the_grant(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3)
    person = LeaseClient(robot.stage.bus.node("desk"), "cmd_vel_mux", identity=Identity("desk", "desk", "keyboard"))
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool("drive", {"speed": 0.1, "turn": 0.3, "seconds": 5.0}))
        await wait_for_motion(robot)
        person.take_over()
        assert "desk (keyboard) has taken over" in text_of(await task)
        assert robot.files.find(robot.assistant.id) is None
        assert "no grant is in force" in text_of(await client.call_tool("drive", {"speed": 0.1}))


@given(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(0.0, 6.3))
def test_robot_stops_as_far_from_a_border_whichever_way_it_drives(ahead: float, left: float, y: float) -> None:
    grant = DriveGrant(60.0, 0.6, (Area(-10.0, -10.0, 10.0, 5.0),))
    if grant.allows(0.0, y, ahead, left):
        assert y + 0.4 * math.hypot(ahead, left) <= 5.0 - 0.05 + 1e-9
    assert grant.allows(0.0, y, ahead, left) == grant.allows(0.0, y, -left, ahead)


async def test_emergency_stop_ends_the_grant(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3)
    person = MuxLink(robot.stage.bus.node("desk"), "cmd_vel_mux")
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool("go_to", {"x": 0.9, "y": 0.0}))
        await wait_for_motion(robot)
        person.ask("stop")
        assert "an emergency stop, and the grant has ended" in text_of(await task)
        assert robot.files.find(robot.assistant.id) is None
    robot.step(0.5)
    assert robot.samples[-1][1] < 0.01


HOSTILE: tuple[tuple[str, dict[str, object], str], ...] = (
    ("drive", {"speed": 1e9}, "speed"),
    ("drive", {"speed": "fast"}, "speed"),
    ("drive", {"speed": 0.1, "seconds": 600.0}, "seconds"),
    ("go_to", {"x": 0.1}, "y"),
    ("go_to", {"x": 0.1, "y": 0.1, "force": True}, "force"),
    ("check", {"paths": ["--fix", "."]}, "begins with a dash"),
    ("start_program", {"name": "../evil"}, "name"),
    ("start_program", {"name": "explore"}, "includes no programs"),
    ("erase", {}, "unknown tool"),
)


async def test_hostile_arguments_are_refused_in_a_line(robot: AssistedRobot) -> None:
    robot.grant()
    async with robot.connect() as client:
        for name, arguments, problem in HOSTILE:
            result = await client.call_tool(name, arguments)
            assert result.is_error
            assert problem in text_of(result)
            assert "\n" not in text_of(result)


async def test_second_call_does_not_drive_while_another_does(robot: AssistedRobot) -> None:
    robot.grant()
    async with robot.connect() as client:
        first = asyncio.create_task(client.call_tool("drive", {"speed": 0.1, "seconds": 2.0}))
        await wait_for_motion(robot)
        assert "another call drives" in text_of(await client.call_tool("drive", {"speed": 0.2}))
        assert "driven" in text_of(await first)


async def test_stop_ends_the_motion_of_another_call(robot: AssistedRobot) -> None:
    robot.grant()
    async with robot.connect() as client:
        first = asyncio.create_task(client.call_tool("go_to", {"x": 0.9, "y": 0.0}))
        await wait_for_motion(robot)
        await client.call_tool("stop", {})
        assert "stopped" in text_of(await first)


async def wait_for_motion(robot: AssistedRobot) -> float:
    """Wait until the robot moves; return the time."""
    start = robot.now
    while robot.samples[-1][1] < 0.08:
        assert robot.now < start + 20.0, robot.assistant.log.read()
        await asyncio.sleep(0)
    return robot.now


async def test_client_of_an_older_version_of_the_protocol_answers_pings(robot: AssistedRobot) -> None:
    robot.grant()
    async with robot.connect_as("legacy") as client:
        assert isinstance(client, Client)
        assert "driven" in text_of(await client.call_tool("drive", {"speed": 0.1, "seconds": 0.5}))
        assert robot.assistant.client != "an assistant"


async def test_client_behind_ssh_drives_with_signs_of_life_only(robot: AssistedRobot) -> None:
    robot.grant()
    async with robot.connect_as("legacy", remote=True) as client:
        assert "driven" in text_of(await client.call_tool("drive", {"speed": 0.1, "seconds": 0.5}))
    at = robot.now
    async with robot.connect_as("2026-07-28", remote=True) as client:
        assert "silent" in text_of(await client.call_tool("drive", {"speed": 0.1, "seconds": 0.5}))
    assert max(speed for when, speed, *_ in robot.samples if when > at + 0.3) < 0.01


async def test_client_behind_ssh_falls_back_to_a_version_that_asks_for_signs_of_life(tmp_path: Path) -> None:
    env = {**os.environ, "HOME": str(tmp_path), "ROS_HOME": str(tmp_path)}
    ssh = {"SSH_CONNECTION": "198.51.100.1 50000 198.51.100.2 22"}
    for connection, versions in (({}, MODERN_PROTOCOL_VERSIONS), (ssh, HANDSHAKE_PROTOCOL_VERSIONS)):
        server = StdioServerParameters(command=str(ROOT / "ur"), args=["mcp"], env={**env, **connection})
        async with Client(stdio_client(server, errlog=sys.__stderr__ or sys.stderr)) as client:
            assert client.protocol_version in versions
            assert len((await client.list_tools()).tools) == len(TOOLS)


def hide_right_half(robot: AssistedRobot, beyond: float) -> tuple[Publisher[Map], Map]:
    """Show a map whose part beyond x (m) is unknown. Returns its publisher, and the whole map."""
    maps: list[Map] = []
    robot.stage.client.subscribe("map", Map, maps.append, Quality.LATCHED)
    robot.step(0.5)
    whole = maps[-1]
    values = whole.grid.values.copy()
    values[:, int((beyond - whole.grid.origin[0]) / whole.grid.resolution) :] = -1
    publisher = robot.stage.bus.node("mapping").publish("map", Map, Quality.LATCHED)
    publisher.send(replace(whole, grid=replace(whole.grid, values=values)))
    robot.step(0.5)
    return publisher, whole


async def test_robot_explores_until_the_map_is_complete(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3)
    publisher, whole = hide_right_half(robot, 0.8)
    async with robot.connect() as client:
        task = asyncio.create_task(client.call_tool("explore", {"seconds": 120.0}))
        await wait_for_motion(robot)
        publisher.send(whole)
        result = await task
        assert not result.is_error, text_of(result)
        assert "the map is complete" in text_of(result)


async def test_exploration_stays_in_the_area_of_the_grant(robot: AssistedRobot) -> None:
    robot.grant(speed=0.3, within=(Area(-0.4, -0.4, 0.3, 0.4),))
    hide_right_half(robot, 0.8)
    async with robot.connect() as client:
        assert "call again to go on" in text_of(await client.call_tool("explore", {"seconds": 12.0}))
    assert max(x for *_, x, _ in robot.samples) < 0.3
