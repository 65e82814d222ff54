"""The two programs as users start them, with a real master."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from tests.ros_session import free_port, wait_for_port

from ur.robot.base import list_bases, load_base
from ur.source.crash import EXIT_CODE

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "ubiquity_launches"
NAVIGATE = PACKAGE / "n_keyboard_navigate/bin/keyboard_navigate_node"
DRIVE = PACKAGE / "n_teleop_twist_keyboard/bin/teleop_twist_keyboard.py"

pytestmark = pytest.mark.ros

Environment = dict[str, str]


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
        [sys.executable, str(Path(__file__).with_name("fake_robot.py"))],
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


def run_piped(program: Path, text: str, env: Environment, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program, *arguments], input=text, env=env, text=True, capture_output=True, timeout=120)


def test_end_of_the_reader_ends_the_batch_without_a_word(environment: Environment) -> None:
    reader, output = os.pipe()
    os.close(reader)
    try:
        lines = "g 2 3\n" * 50
        done = subprocess.run(
            [NAVIGATE], input=lines, env=environment, text=True, stdout=output, stderr=subprocess.PIPE, timeout=120
        )
    finally:
        os.close(output)
    assert done.stderr == ""
    assert done.returncode == 128 + signal.SIGPIPE


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


@pytest.mark.parametrize("program", [NAVIGATE, DRIVE], ids=lambda path: path.name)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP], ids=lambda number: number.name)
def test_terminal_is_restored_after_a_signal(environment: Environment, program: Path, number: signal.Signals) -> None:
    shown = OnTerminal([program], environment)
    try:
        shown.wait_for("keyboard")
        shown.process.send_signal(number)
        assert shown.wait_end() == 0
        screen = shown.read()
        assert termios.tcgetattr(shown.terminal) == shown.before
        assert screen.rfind("\x1b[?1049l") > screen.rfind("\x1b[?1049h") >= 0
        assert "Traceback" not in screen
    finally:
        shown.close()


class OnTerminal:
    """A program on a pseudo-terminal, with what it has written there so far."""

    def __init__(self, command: list[str | Path], env: Environment) -> None:
        self.user, self.terminal = os.openpty()
        self.before = termios.tcgetattr(self.terminal)
        self.written = b""
        self.process = subprocess.Popen(
            command, env=env, stdin=self.terminal, stdout=self.terminal, stderr=self.terminal, start_new_session=True
        )
        os.set_blocking(self.user, False)

    def read(self) -> str:
        with contextlib.suppress(BlockingIOError):
            while True:
                self.written += os.read(self.user, 65536)
        return self.written.decode(errors="replace")

    def wait_for(self, text: str) -> None:
        deadline = time.monotonic() + 60
        while text not in self.read():
            assert time.monotonic() < deadline, self.read()
            assert self.process.poll() is None or text in self.read(), self.read()
            time.sleep(0.02)

    def type(self, text: str) -> None:
        os.write(self.user, text.encode())

    def wait_end(self) -> int:
        deadline = time.monotonic() + 60
        while self.process.poll() is None:
            assert time.monotonic() < deadline, self.read()
            self.read()
            time.sleep(0.02)
        return self.process.returncode

    def close(self) -> None:
        self.process.kill()
        self.process.wait(60)
        os.close(self.terminal)
        os.close(self.user)


def crash_in(where: str) -> list[str | Path]:
    """A program that owns the screen and fails there, or in a callback of its node."""
    lines = [
        "import sys",
        "from ur_nodes.run import run_foreground",
        "from ur_nodes.teleop.terminal.raw import own_terminal",
        "def fail():",
        "    {}['gone']",
        "def body(node, ended):",
        "    with own_terminal(0, 1):",
        f"        {where}",
        "    return 0",
        "sys.exit(run_foreground('crasher', lambda node: node, body))",
    ]
    return [sys.executable, "-c", "\n".join(lines)]


@pytest.mark.parametrize("where", ["fail()", "node.post(fail); ended.wait(60)"], ids=["user interface", "node"])
def test_exception_leaves_the_terminal_as_it_was_and_one_line_that_names_the_traceback(
    environment: Environment, where: str
) -> None:
    program = OnTerminal(crash_in(where), environment)
    try:
        assert program.wait_end() == EXIT_CODE
        shown = program.read()
        assert termios.tcgetattr(program.terminal) == program.before
        after = shown[shown.rindex("\x1b[?1049l") + len("\x1b[?1049l") :]
        assert after.count("\n") == 1
        assert "error: internal error in 'crasher': KeyError: 'gone'; please report it with the file " in after
        report = Path(after.split("with the file ")[1].strip())
        assert report.parent == Path(environment["ROS_LOG_DIR"])
        assert "Traceback" in report.read_text()
        assert "Traceback" not in shown
    finally:
        program.close()


@pytest.mark.parametrize("program", [NAVIGATE, DRIVE], ids=lambda path: path.name)
def test_program_whose_name_another_one_takes_says_so(environment: Environment, program: Path) -> None:
    first = OnTerminal([program, "__name:=twin"], environment)
    second = None
    try:
        first.wait_for("keyboard")
        second = OnTerminal([program, "__name:=twin"], environment)
        assert first.wait_end() == 1
        assert "ended, because another node registered as /twin" in first.read()
    finally:
        first.close()
        if second:
            second.close()


def test_dumb_terminal_gets_lines_and_a_goal_can_be_stopped_by_one(environment: Environment) -> None:
    program = OnTerminal([NAVIGATE, "__name:=lines"], environment | {"TERM": "dumb"})
    try:
        program.wait_for("one command a line")
        program.type("foo\ng 4 4\nc\nx\n")
        program.wait_for("unknown command 'foo'")
        program.wait_for("g 4 4: stopped after")
        program.type("q\n")
        assert program.wait_end() == 1, "one line was not understood"
        assert "\x1b" not in program.read()
    finally:
        program.close()


def test_keys_drive_on_a_dumb_terminal_without_escape_sequences(environment: Environment) -> None:
    program = OnTerminal([DRIVE, "__name:=dumb_keys"], environment | {"TERM": "dumb"})
    try:
        program.wait_for("stopped")
        program.type("i")
        program.wait_for("driving   +0.50 m/s")
        program.type("\x03")
        assert program.wait_end() == 0
        assert "\x1b" not in program.read()
        assert termios.tcgetattr(program.terminal) == program.before
    finally:
        program.close()


@pytest.mark.parametrize("program", [NAVIGATE, DRIVE], ids=lambda path: path.name)
def test_no_color_is_obeyed(environment: Environment, program: Path) -> None:
    shown = OnTerminal([program, "__name:=grey"], environment | {"NO_COLOR": "1"})
    try:
        shown.wait_for("subscriber" if program == DRIVE else "m/s")
        shown.type("\x03")
        assert shown.wait_end() == 0
        styles = set(re.findall(r"\x1b\[([0-9;]*)m", shown.read()))
        assert program == NAVIGATE or not {code for style in styles for code in style.split(";") if len(code) > 1}
    finally:
        shown.close()


def test_parameters_obey_the_limits_of_each_base() -> None:
    for name in list_bases(PACKAGE):
        limits = load_base(PACKAGE, name).limits
        given = yaml.safe_load((PACKAGE / f"n_teleop_twist_keyboard/params/{name}.yaml").read_text())
        assert given["speed_limit"] == limits.velocity, name
        assert given["turn_limit"] == limits.angular_velocity, name
        assert given["speed"] <= limits.velocity, name
        assert given["turn"] <= limits.angular_velocity, name
