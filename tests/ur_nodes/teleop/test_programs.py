"""The two programs as users start them, with a real master."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from ur.robot.base import list_bases, load_base

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "ubiquity_launches"
NAVIGATE = PACKAGE / "n_keyboard_navigate/bin/keyboard_navigate_node"
DRIVE = PACKAGE / "n_teleop_twist_keyboard/bin/teleop_twist_keyboard.py"

pytestmark = pytest.mark.ros

Environment = dict[str, str]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return int(probe.getsockname()[1])


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Environment]:
    """A master and the fake robot."""
    folder = tmp_path_factory.mktemp("ros")
    port = free_port()
    env = os.environ | {
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(folder),
        "ROS_LOG_DIR": str(folder / "log"),
        "XDG_DATA_HOME": str(folder / "data"),
        "TERM": "xterm-256color",
    }
    commands = (
        ["rosmaster", "--core", "-p", str(port)],
        [sys.executable, str(Path(__file__).with_name("fake_robot_node.py"))],
    )
    quiet = subprocess.DEVNULL
    started: list[subprocess.Popen[bytes]] = []
    try:
        for command in commands:
            started.append(subprocess.Popen(command, env=env, stdout=quiet, stderr=quiet))
            wait_for_port(port)
        yield env
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait(60)


def wait_for_port(port: int) -> None:
    deadline = time.monotonic() + 60
    with contextlib.closing(socket.socket()) as probe:
        while probe.connect_ex(("localhost", port)):
            assert time.monotonic() < deadline, "no master"
            time.sleep(0.05)


def run_piped(program: Path, text: str, env: Environment, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program, *arguments], input=text, env=env, text=True, capture_output=True, timeout=120)


def test_piped_goals_are_driven_and_reported(environment: Environment) -> None:
    done = run_piped(NAVIGATE, "g 2 3 90\nw corner\ng 0 0 0\nm corner\n", environment, "_map_name:=test")
    assert done.stderr == ""
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0].startswith("g 2 3 90: reached, 0.0")
    assert lines[1] == "w corner: remembered 2.00 3.00 90"
    assert lines[3].startswith("m corner: reached")
    assert (Path(environment["XDG_DATA_HOME"]) / "ubiquity_launches/waypoints/test.yaml").is_file()


def test_failed_goal_and_malformed_line_exit_with_1(environment: Environment) -> None:
    done = run_piped(NAVIGATE, "g 2 x\ng 90 90\ng 1 1\n", environment)
    assert done.returncode == 1
    assert done.stderr == "error: g 2 x: 'x' is not a number, expected: g X Y [ANGLE]\n"
    failed, reached = done.stdout.splitlines()
    assert failed.startswith("g 90 90: failed after")
    assert failed.endswith(": the goal is off the map")
    assert reached.startswith("g 1 1: reached")


def test_what_does_not_come_is_named_after_the_limit(environment: Environment) -> None:
    done = run_piped(NAVIGATE, "g 1 1\n", environment, "map:=nowhere", "move_base/status:=no", "_start_timeout:=8.0")
    assert done.returncode == 2
    assert "still waiting for the map (topic /nowhere) and navigation (action /move_base) after 8 s" in done.stderr


def test_bad_parameter_is_one_clear_line(environment: Environment) -> None:
    done = run_piped(DRIVE, "", environment, "_speed_limit:=fast", "__name:=strict")
    assert done.returncode == 2
    assert "parameter /strict/speed_limit: 'fast', expected a number" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("program", [NAVIGATE, DRIVE], ids=lambda path: path.name)
def test_no_master_is_one_clear_line(environment: Environment, program: Path) -> None:
    nowhere = environment | {"ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    done = run_piped(program, "g 1 1\n", nowhere)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert "no ROS master at http://localhost:" in done.stderr


def test_keys_of_a_pipe_drive(environment: Environment) -> None:
    listener = "import sys, rospy\nfrom geometry_msgs.msg import Twist\nrospy.init_node('listener')\n"
    listener += "rospy.Subscriber('keys', Twist, lambda m: print(m.linear.x, m.angular.z, flush=True))\nrospy.spin()"
    with subprocess.Popen(
        [sys.executable, "-c", listener], env=environment, stdout=subprocess.PIPE, text=True
    ) as heard:
        try:
            done = run_piped(DRIVE, "io", environment, "cmd_vel:=keys", "_speed:=0.25", "_turn:=0.5")
            assert (done.returncode, done.stderr) == (0, "")
            assert heard.stdout is not None
            lines = [heard.stdout.readline().strip()]
            while lines[-1] not in ("0.0 0.0", ""):
                lines.append(heard.stdout.readline().strip())
        finally:
            heard.terminate()
    assert lines[0] == "0.25 0.0"
    assert "0.25 -0.5" in lines
    assert lines[-1] == "0.0 0.0"


@pytest.mark.parametrize("program", [NAVIGATE, DRIVE], ids=lambda path: path.name)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP], ids=lambda number: number.name)
def test_terminal_is_restored_after_a_signal(environment: Environment, program: Path, number: signal.Signals) -> None:
    user, terminal = os.openpty()
    before = termios.tcgetattr(terminal)
    screen = b""
    try:
        process = subprocess.Popen(
            [program], env=environment, stdin=terminal, stdout=terminal, stderr=terminal, start_new_session=True
        )
        deadline = time.monotonic() + 60
        while b"keyboard" not in screen:
            assert time.monotonic() < deadline, screen
            screen += os.read(user, 65536)
        process.send_signal(number)
        os.set_blocking(user, False)
        while process.poll() is None:
            assert time.monotonic() < deadline, "still running"
            try:
                screen += os.read(user, 65536)
            except BlockingIOError:
                time.sleep(0.02)
        assert process.returncode == 0
        with contextlib.suppress(BlockingIOError):
            screen += os.read(user, 65536)
        assert termios.tcgetattr(terminal) == before
        assert screen.rfind(b"\x1b[?1049l") > screen.rfind(b"\x1b[?1049h") >= 0
        assert b"Traceback" not in screen
    finally:
        os.close(terminal)
        os.close(user)


def test_parameters_obey_the_limits_of_each_base() -> None:
    for name in list_bases(PACKAGE):
        limits = load_base(PACKAGE, name).limits
        given = yaml.safe_load((PACKAGE / f"n_teleop_twist_keyboard/params/{name}.yaml").read_text())
        assert given["speed_limit"] == limits.velocity, name
        assert given["turn_limit"] == limits.angular_velocity, name
        assert given["speed"] <= limits.velocity, name
        assert given["turn"] <= limits.angular_velocity, name
