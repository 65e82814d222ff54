"""Every command of the tutorial, typed into a real terminal in its order, by a user who has nothing yet."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.terminal import ROOT, Terminal

pytestmark = [
    pytest.mark.ros,
    pytest.mark.timeout(900),
    pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed"),
]
_BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    kind: str  # bash: typed line by line; keys: typed, looked at, quit; file: written; edit: its first line is replaced
    path: str
    text: str


BLOCKS = [Block(*found) for found in _BLOCK.findall((ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8"))]


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    own = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost", "PS1": "$ "}
    opened = Terminal(["bash", "--noprofile", "--norc", "-i"], tmp_path, own)
    (tmp_path / "ur").unlink()  # the tutorial says how ur gets on PATH
    opened.type(f"cd {ROOT}", "Enter")
    try:
        yield opened
    finally:
        opened.close()  # whatever runs in it ends with it
        done = subprocess.run(
            [ROOT / ".venv/bin/python", "-m", "ur", "stop", "--all"],
            env={**os.environ, "HOME": str(tmp_path)},
            check=False,
        )
        assert done.returncode in (0, 2)  # 2: nothing runs


def run(terminal: Terminal, command: str) -> None:
    mark = uuid.uuid4().hex[:8]  # what the command before this one left on the screen is no answer to this one
    terminal.type(f'clear; {command}; echo "{mark}"=$?', "Enter")
    screen = terminal.until(f"{mark}=", 120.0)
    assert f"{mark}=0" in screen, f"{command}:\n{screen}"


def test_every_command_of_the_tutorial_works(terminal: Terminal, tmp_path: Path) -> None:
    package = tmp_path / "robots" / "my_robot"
    for block in BLOCKS:
        if block.kind == "bash":
            for line in block.text.splitlines():
                run(terminal, line)
        elif block.kind == "keys":
            terminal.type("clear; " + block.text.strip() + "; echo en''ded", "Enter")
            terminal.until("maze", 120.0)
            terminal.until("localised", 120.0)
            terminal.type("q", "Enter")
            terminal.until("ended", 120.0)
            run(terminal, "true")
        elif block.kind == "file":
            (package / block.path).parent.mkdir(parents=True, exist_ok=True)
            (package / block.path).write_text(block.text)
        else:
            first = block.text.splitlines(keepends=True)[0]
            before = (package / block.path).read_text()
            assert before.count(first) == 1, f"{block.path} has no line {first!r}:\n{before}"
            (package / block.path).write_text(before.replace(first, block.text))


def test_tutorial_has_steps_of_every_kind() -> None:
    assert {block.kind for block in BLOCKS} == {"bash", "keys", "file", "edit"}
    assert sum(len(block.text.splitlines()) for block in BLOCKS if block.kind == "bash") > 25
