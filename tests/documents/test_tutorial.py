"""Every command of the tutorial, typed into a real terminal in its order, by a user who has nothing yet."""

import math
import os
import re
import shutil
import subprocess
import time
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.ros_session import free_port
from tests.terminal import ROOT, TmuxTerminal

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(900),
    pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed"),
]
_FINDING = re.compile(r"(?:^|\s)(?:error|warning|note|help): ")
_BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    # bash: typed line by line; keys: typed, looked at, quit; watch: typed in a second terminal, looked at after the
    # next block, and quit; second: typed in a second terminal, used, ended by Ctrl-C; file: written; edit: its first
    # line is replaced; diff: its line with - is replaced by the one with +
    kind: str
    path: str
    text: str


BLOCKS = [Block(*found) for found in _BLOCK.findall((ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8"))]


@pytest.fixture
def terminals(tmp_path: Path) -> Iterator[tuple[TmuxTerminal, TmuxTerminal]]:
    """The first and the second terminal of the tutorial."""
    port = free_port()
    own = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost", "PS1": "$ "}
    opened = []
    try:
        for _ in range(2):
            opened.append(TmuxTerminal(["bash", "--noprofile", "--norc", "-i"], tmp_path, own))
            (tmp_path / "ur").unlink()  # the tutorial says how ur gets on PATH
            opened[-1].type(f"cd {ROOT}", "Enter")
        yield opened[0], opened[1]
    finally:
        for terminal in opened:
            terminal.close()  # whatever runs in it ends with it
        done = subprocess.run(
            [ROOT / ".venv/bin/python", "-m", "ur", "stop", "--all"],
            env={**os.environ, "HOME": str(tmp_path)},
            check=False,
        )
        assert done.returncode in (0, 2)  # 2: nothing runs


def run(terminal: TmuxTerminal, command: str) -> str:
    mark = uuid.uuid4().hex[:8]  # what the command before this one left on the screen is no answer to this one
    terminal.type(f'clear; {command}; echo "{mark}"=$?', "Enter")
    screen = terminal.until(f"{mark}=", 120.0)
    assert f"{mark}=0" in screen, f"{command}:\n{screen}"
    return screen


def drive(terminal: TmuxTerminal, first: TmuxTerminal, command: str) -> None:
    """Join the robot that runs, drive it, and leave it running."""
    terminal.type(f"clear; {command}; echo en''ded=$?", "Enter")
    end = time.monotonic() + 120.0
    while not re.search(r"[1-9] subscriber", terminal.screen()):  # the mux, and the black box once it has looked
        assert time.monotonic() < end, terminal.screen()
        time.sleep(0.05)
    assert "■ stopped" in terminal.screen()
    end = time.monotonic() + 60.0
    while "▲ driving" not in terminal.screen():  # it ends soon after each press
        assert time.monotonic() < end, terminal.screen()
        terminal.type("i")
    terminal.type("C-c")
    screen = terminal.until("ended=", 60.0)
    assert re.search(r"joining the robot that m_wander\.\d+ started", screen), screen
    run(first, "ur ps | grep m_wander")


def begin_to_watch(terminal: TmuxTerminal, command: str) -> None:
    """Start the map in the second terminal, and leave it open."""
    terminal.type("clear; " + command + "; echo en''ded", "Enter")
    terminal.until("localised", 120.0)


def see_it_wander(terminal: TmuxTerminal, first: TmuxTerminal) -> None:
    """See the robot move on the map of the second terminal, quit there, and see what had joined end."""
    before = pose_on(terminal)
    end = time.monotonic() + 60.0
    while math.dist(before, pose_on(terminal)) < 0.3:
        assert time.monotonic() < end, terminal.screen()
        time.sleep(0.2)
    run(first, "ur ps | grep m_wander")
    terminal.type("q", "Enter")
    terminal.until("uses this robot; it ends with this program. Press q again to end it")
    terminal.type("q")
    terminal.until("ended", 120.0)
    first.type("clear; while ur ps | grep m_; do sleep 0.2; done; echo go''ne", "Enter")
    first.until("gone", 60.0)


def pose_on(terminal: TmuxTerminal) -> tuple[float, float]:
    """The x and y (m) that the map's program shows."""
    end = time.monotonic() + 60.0
    while (found := re.search(r"x (-?[\d.]+) y (-?[\d.]+)", terminal.screen())) is None:
        assert time.monotonic() < end, terminal.screen()
        time.sleep(0.2)
    return float(found[1]), float(found[2])


def test_every_command_of_the_tutorial_works(terminals: tuple[TmuxTerminal, TmuxTerminal], tmp_path: Path) -> None:
    terminal, second = terminals
    package = tmp_path / "robots" / "my_robot"
    watching = False
    for block in BLOCKS:
        if block.kind == "bash":
            screens = "".join(run(terminal, line) for line in block.text.splitlines())
            found = [line for line in screens.splitlines() if _FINDING.search(line)]
            assert not found, f"the tutorial does not announce these lines: {found}"
            if watching:
                assert re.search(r"joining the robot that m_keyboard_navigate\.\d+ started", screens), screens
                see_it_wander(second, terminal)
                watching = False
        elif block.kind == "watch":
            begin_to_watch(second, block.text.strip())
            watching = True
        elif block.kind == "keys":
            terminal.type("clear; " + block.text.strip() + "; echo en''ded", "Enter")
            terminal.until("maze", 120.0)
            terminal.until("localised", 120.0)
            terminal.type("q", "Enter")
            terminal.until("ended", 120.0)
            run(terminal, "true")
        elif block.kind == "second":
            drive(second, terminal, block.text.strip())
        elif block.kind == "file":
            (package / block.path).parent.mkdir(parents=True, exist_ok=True)
            (package / block.path).write_text(block.text)
        else:
            lines = block.text.splitlines(keepends=True)
            old, new = (lines[0][1:], lines[1][1:]) if block.kind == "diff" else (lines[0], block.text)
            before = (package / block.path).read_text()
            assert before.splitlines(keepends=True).count(old) == 1, f"{block.path} has no line {old!r}:\n{before}"
            (package / block.path).write_text(before.replace(old, new))


def test_tutorial_has_steps_of_every_kind() -> None:
    assert {block.kind for block in BLOCKS} == {"bash", "keys", "watch", "second", "file", "edit", "diff"}
    assert sum(len(block.text.splitlines()) for block in BLOCKS if block.kind == "bash") > 25
