"""Joystick, keyboard and mux before a simulated robot, over a real master, wired by robot.launch."""

import os
import signal
import subprocess
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.e2e.conftest import PYTHON, ROOT, end, list_family, make_environment
from tests.ros_session import Client
from tests.ur_nodes.motion.joystick.virtual_joystick import UINPUT, PipeJoystick, UinputJoystick, VirtualJoystick

pytestmark = pytest.mark.ros

HERE = Path(__file__).parent
DEAD_MAN = 4


class JoystickRobot(Client):
    """The launched robot, its joystick, and the client's requests as calls."""

    def __init__(self, launch: subprocess.Popen[str], env: dict[str, str], joystick: VirtualJoystick) -> None:
        pipe = subprocess.PIPE
        command = [str(PYTHON), "-m", "tests.ur_nodes.motion.motion_client_node"]
        super().__init__(subprocess.Popen(command, cwd=ROOT, env=env, text=True, stdin=pipe, stdout=pipe), limit=150.0)
        self.launch = launch
        self.env = env
        self.joystick = joystick


@pytest.fixture(scope="module")
def joystick(tmp_path_factory: pytest.TempPathFactory) -> Iterator[VirtualJoystick]:
    """A device of the kernel where it has uinput, else a pipe that speaks the same format."""
    made: VirtualJoystick
    made = UinputJoystick() if UINPUT.exists() else PipeJoystick(tmp_path_factory.mktemp("dev") / "js0")
    yield made
    made.close()


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory, joystick: VirtualJoystick) -> Iterator[JoystickRobot]:
    folder = tmp_path_factory.mktemp("motion")
    env = make_environment(folder)
    command = [str(ROOT / "ur"), "launch", str(HERE / "robot.launch"), "robot_base:=stage", f"dev:={joystick.device}"]
    with (folder / "launch.log").open("w") as log:
        launch = subprocess.Popen(
            command, env=env, text=True, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, cwd=folder
        )
    started = JoystickRobot(launch, env, joystick)
    try:
        assert started.ask("ready", seconds=150) == "idle"
        yield started
    finally:
        started.client.kill()
        started.client.wait()
        end(launch)


@pytest.fixture(autouse=True)
def rested(robot: JoystickRobot) -> Iterator[None]:
    """Each test begins and ends with a robot that stands and nobody who drives."""
    robot.ask("history")
    yield
    robot.ask("rest")
    for axis in (0, 1):
        robot.joystick.push(axis, 0)
    robot.joystick.press(DEAD_MAN, False)
    robot.ask("stands", seconds=60)


def drivers(names: list[str]) -> list[str]:
    """Who drove, one after another. On a slow moment of the computer nobody may have driven in between."""
    driving = [name for name in names if name != "idle"]
    return [name for n, name in enumerate(driving) if n == 0 or driving[n - 1] != name]


def test_joystick_drives_while_its_dead_man_button_is_held(robot: JoystickRobot, record_property: Any) -> None:
    kernel = isinstance(robot.joystick, UinputJoystick)
    pipe = f"a pipe that speaks as a device does, read by joy_node: there is no {UINPUT}"
    record_property("joystick", f"a virtual device of the kernel ({UINPUT})" if kernel else pipe)
    robot.joystick.push(1, 32767)  # back, without the button
    robot.joystick.push(1, 0)
    robot.joystick.press(0, True)
    robot.joystick.press(0, False)
    assert robot.ask("history")["commands"] == []
    robot.joystick.press(DEAD_MAN, True)
    robot.joystick.push(1, -32767)
    assert robot.ask("moves", seconds=60) > 0.0
    robot.joystick.press(DEAD_MAN, False)
    robot.ask("stands", seconds=60)
    told = robot.ask("history")
    assert drivers(told["active"]) == ["joystick"]
    assert told["active"][-1] == "idle"
    speeds = [forward for forward, _ in told["commands"]]
    assert min(speeds) >= 0.0
    assert max(speeds) <= 0.5
    assert speeds[-3:] == [0.0, 0.0, 0.0]
    assert max(b - a for a, b in pairwise(speeds)) <= 1.0 * 0.02 + 1e-6


def test_keyboard_drives_before_navigation_and_joystick_before_both(robot: JoystickRobot) -> None:
    robot.ask("drive", topic="nav_vel", velocity=[0.0, 0.3])
    teleop = ROOT / "ubiquity_launches" / "n_teleop_twist_keyboard" / "bin" / "teleop_twist_keyboard.py"
    keys = subprocess.run(
        [str(teleop), "cmd_vel:=key_vel"], env=robot.env, input="jj", text=True, capture_output=True, timeout=120
    )
    assert keys.returncode == 0, keys.stderr
    robot.joystick.press(DEAD_MAN, True)
    robot.joystick.push(1, -32767)
    robot.ask("moves", seconds=60)
    robot.joystick.press(DEAD_MAN, False)
    robot.ask("is_active", name="navigation", seconds=60)
    robot.ask("rest")
    robot.ask("stands", seconds=60)
    drove = drivers(robot.ask("history")["active"])
    keyboard, joystick = drove.index("keyboard"), drove.index("joystick")
    assert drove[0] == drove[-1] == "navigation"  # which wanted to all the time
    assert "navigation" in drove[keyboard:joystick]
    assert "keyboard" not in drove[joystick:]


def test_new_mux_sends_a_stop_to_the_base(robot: JoystickRobot) -> None:
    robot.ask("history")  # no client drives, so what is published from now on is the new mux's stop
    kill_mux(robot)
    robot.ask("hears", velocity=[0.0, 0.0], seconds=60)  # for drivers that go on with the last command they received
    assert robot.ask("ready", seconds=150) == "idle"


def kill_mux(robot: JoystickRobot) -> None:
    (mux,) = (
        pid for pid in list_family(robot.launch.pid) if "cmd_vel_mux_node" in " ".join(psutil.Process(pid).cmdline())
    )
    robot.ask("forget")
    os.kill(mux, signal.SIGKILL)
