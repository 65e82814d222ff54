"""Who may drive, and that the robot stands whatever dies: real programs, real nodes. How fast it stands: bench/stop.

The default suite has the same on a bus: test_cmd_vel_mux_node.py in tests/ur_nodes/motion/, test_move_base.py in
tests/ur_nodes/navigation/, tests/ur_nodes/teleop/, and with nodes that start again tests/ur_nodes/first_drive/.
"""

import os
import signal
import subprocess
import xmlrpc.client
from typing import Any

import pytest
from tests.e2e.conftest import ROOT, LaunchedRobot
from tests.e2e.terminal import ProgramTerminal
from tests.e2e.test_first_drive import GOALS, find_node, put_at_start
from tests.json_client import wait_until

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]

KEYBOARD = str(ROOT / "ubiquity_launches" / "n_teleop_twist_keyboard" / "bin" / "teleop_twist_keyboard.py")
NAVIGATE = str(ROOT / "ubiquity_launches" / "n_keyboard_navigate" / "bin" / "keyboard_navigate_node")
ON_KEYS = ("cmd_vel:=key_vel", "_speed:=0.3", "_turn:=0.6")


def stand(robot: LaunchedRobot, *, holding: bool = False) -> None:
    """It stands, and no client drives any more, unless a key is held that drives nowhere."""
    robot.ask("still", seconds=150)
    if not holding:
        robot.ask("active", name="idle", seconds=150)


def publishes(robot: LaunchedRobot, node: str) -> bool:
    """Return whether a node publishes anything besides its log."""
    with xmlrpc.client.ServerProxy(robot.env["ROS_MASTER_URI"]) as master:
        answer: Any = master.getSystemState("/test")
    return any(node in nodes for topic, nodes in answer[2][0] if topic != "/rosout")


def test_keyboard_takes_over_from_navigation_which_then_goes_on(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    stand(robot)
    pipe = subprocess.PIPE
    with subprocess.Popen([KEYBOARD, *ON_KEYS], env=robot.env, stdin=pipe, stderr=pipe, text=True) as keys:
        wait_until(lambda: publishes(robot, "/teleop_twist_keyboard"), 60.0, "the keyboard")
        robot.ask("goal", x=2.5, y=0.0, degrees=0.0)
        robot.ask("moving", seconds=150)
        _, errors = keys.communicate("jl", timeout=150)
    assert keys.returncode == 0, errors
    result = robot.ask("result", seconds=150)
    assert result["state"] == "SUCCEEDED", result["text"]
    told = robot.ask("active", name="idle", seconds=150)["active"]
    assert "keyboard" in told[1:-1]
    before, after = told[: told.index("keyboard")], told[told.index("keyboard") :]
    assert "navigation" in before
    assert "navigation" in after


def test_space_in_keyboard_navigate_stops_the_robot_until_the_release(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    with ProgramTerminal([NAVIGATE, "__name:=navigate_by_hand"], robot.env) as terminal:
        terminal.wait_for("localised")
        terminal.type("g 7.23 10.63\r")
        robot.ask("moving", seconds=150)
        terminal.type(" ")
        terminal.wait_for("EMERGENCY STOP")
        robot.ask("stopped", value=True, seconds=150)
        stand(robot)
        terminal.type("g 1 0\r")
        terminal.wait_for("not sent: the emergency stop is on")
        terminal.type("r\r")
        robot.ask("stopped", value=False, seconds=150)
        stand(robot)
        terminal.wait_for("localised")
        terminal.type("g 1.5 0 0\r")
        terminal.wait_for("reached 1.50 0.00 0")


def test_space_in_keyboard_drive_stops_navigation_too(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    robot.ask("goal", **GOALS["far"])
    robot.ask("moving", seconds=150)
    with ProgramTerminal([KEYBOARD, *ON_KEYS, "__name:=drive_by_hand"], robot.env) as terminal:
        terminal.wait_for("navigation drives")
        terminal.type(" ")
        terminal.wait_for("EMERGENCY STOP")
        assert robot.ask("result", seconds=150)["text"] == "emergency stop"
        stand(robot)
        terminal.type("r")
        robot.ask("stopped", value=False, seconds=150)
        terminal.wait_for("■ stopped")
        terminal.hold("i")
        robot.ask("moving", seconds=150)
        terminal.hold("")
        stand(robot)


def test_robot_driven_by_hand_stops_before_a_wall_until_that_is_turned_off(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    touched = robot.ask("where")["collisions"]
    with ProgramTerminal([KEYBOARD, *ON_KEYS, "__name:=drive_by_hand"], robot.env) as terminal:
        terminal.wait_for("■ stopped")
        terminal.hold(",")  # a wall is 0.3 m behind
        terminal.wait_for("slowed: obstacle")
        terminal.wait_for("stopped: obstacle close behind")
        stand(robot, holding=True)
        where = robot.ask("where")
        assert where["collisions"] == touched
        assert -0.295 < where["true"][0] < -0.2
        terminal.hold("i")
        robot.ask("moving", seconds=150)
        terminal.hold("")
        stand(robot)
        terminal.type("g")
        terminal.wait_for("the obstacle stop is off; g turns it on")
        put_at_start(robot)
        terminal.wait_for("■ stopped")
        terminal.hold(",")
        robot.ask("touched", count=touched + 1, seconds=150)
        terminal.hold("")
        stand(robot)
        terminal.type("g")
        terminal.wait_for("■ stopped")
        assert robot.ask("obstacle_stop", state="clear", seconds=150) == {}


def test_robot_stands_when_the_keyboard_is_killed(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    with ProgramTerminal([KEYBOARD, *ON_KEYS, "__name:=drive_by_hand"], robot.env) as terminal:
        terminal.wait_for("■ stopped")
        terminal.hold("i")
        robot.ask("moving", seconds=150)
        terminal.kill()
        stand(robot)


def test_robot_stands_when_the_network_to_the_keyboard_is_gone(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    with ProgramTerminal([KEYBOARD, *ON_KEYS, "__name:=drive_by_hand"], robot.env) as terminal:
        terminal.wait_for("■ stopped")
        terminal.hold("i")
        robot.ask("moving", seconds=150)
        terminal.process.send_signal(signal.SIGSTOP)  # connections stay open, nothing comes any more
        stand(robot)


@pytest.mark.parametrize("name", ["move_base", "cmd_vel_mux"])
def test_robot_stands_when_a_node_that_drives_it_is_killed_and_drives_again_when_it_is_back(
    robot: LaunchedRobot, name: str
) -> None:
    put_at_start(robot)
    robot.ask("goal", **GOALS["far"])
    robot.ask("moving", seconds=150)
    victim = find_node(robot, name)
    os.kill(victim, signal.SIGKILL)
    if name == "move_base":  # navigation goes on by itself when only the mux was gone
        stand(robot)
    find_node(robot, name, other_than=victim, seconds=150)
    robot.ask("ready", seconds=150)
    put_at_start(robot)
    result = robot.ask("goal", x=1.0, y=0.0, degrees=0.0, seconds=150)
    assert result["state"] == "SUCCEEDED", result["text"]
