"""The main job, whole: real master, real nodes, the simulated robot. One robot serves all tests of this file."""

import math
import os
import signal
import time
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.e2e.conftest import ROOT, LaunchedRobot, list_family
from tests.e2e.terminal import ProgramTerminal

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]

START = {"x": 0.0, "y": 0.0, "degrees": 0.0}


def distance(first: list[float], second: tuple[float, float] | list[float]) -> float:
    return math.hypot(first[0] - second[0], first[1] - second[1])


def put_at_start(robot: LaunchedRobot) -> None:
    """Stop the robot at the start, localised there, with no emergency and no lease left by a test that failed."""
    robot.ask("call", service="cmd_vel_mux/release")
    robot.ask("stopped", value=False, seconds=150)
    robot.ask("free", seconds=150)
    robot.ask("cancel")
    robot.ask("still", seconds=150)
    assert robot.ask("place", **START)["success"]
    robot.ask("believe", **START, seconds=150)


def read_command(pid: int) -> list[str]:
    try:
        return psutil.Process(pid).cmdline()
    except psutil.NoSuchProcess:
        return []


def find_node(robot: LaunchedRobot, name: str, other_than: int = 0, seconds: float = 150.0) -> int:
    """The process id of a node, waited for."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        for pid in list_family(robot.launch.pid):
            if pid != other_than and f"__name:={name}" in read_command(pid):
                return pid
        time.sleep(0.1)
    raise AssertionError(f"no process of the node {name} within {seconds:g} s")


def test_robot_drives_as_told_and_stops_when_the_commands_stop(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    before = robot.ask("where")["true"]
    robot.ask("drive", forward=0.3, turn=0.0, seconds=1.0)
    after = robot.ask("still", seconds=150)["true"]
    assert 0.02 < distance(before, after) < 1.5  # 0.3 m, had the computer all the time it needs


def test_robot_reaches_a_goal(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    result = robot.ask("goal", x=1.5, y=0.0, degrees=90.0, seconds=150)
    assert result["state"] == "SUCCEEDED", result["text"]
    x, y, yaw = result["true"]
    assert math.hypot(x - 1.5, y) < 0.15
    assert abs(math.degrees(yaw) - 90.0) < 8.0


def test_kidnapped_robot_finds_itself_again(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    assert robot.ask("place", **GOALS["far"])["success"]
    robot.ask("globalise")
    for _ in range(12):
        where = robot.ask("drive", forward=0.0, turn=0.8, seconds=4.0)
        if distance(where["true"], where["believed"]) < 0.2:
            break
    assert distance(where["true"], where["believed"]) < 0.2, where


@pytest.mark.parametrize("name", ["amcl", "move_base"])
def test_killed_node_is_restarted_and_the_robot_goes_on(robot: LaunchedRobot, name: str) -> None:
    put_at_start(robot)
    victim = find_node(robot, name)
    os.kill(victim, signal.SIGKILL)
    find_node(robot, name, other_than=victim)
    robot.ask("ready", seconds=150)
    put_at_start(robot)
    result: dict[str, Any] = robot.ask("goal", x=1.0, y=0.0, degrees=0.0, seconds=150)
    assert result["state"] == "SUCCEEDED", result["text"]


GOALS = {"far": {"x": 7.23, "y": 10.63, "degrees": 160.0}}


def test_robot_stands_when_the_viewer_is_killed_and_the_robot_side_lives_on(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    launch = Path(__file__).with_name("viewer.launch")
    with ProgramTerminal([str(ROOT / "ur"), "launch", str(launch), "robot_base:=stage"], robot.env) as viewer:
        viewer.wait_for("■ stopped")
        viewer.hold("i")
        robot.ask("moving", seconds=150)
        viewer.process.kill()  # `ur` alone: what it started must not live on
        robot.ask("still", seconds=150)
        robot.ask("active", name="idle", seconds=150)
    result = robot.ask("goal", x=1.0, y=0.0, degrees=0.0, seconds=150)
    assert result["state"] == "SUCCEEDED", result["text"]
