"""Tab in real shells, on a real terminal."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.complete.shells import SCRIPTS

ROOT = Path(__file__).parents[2]
STARTS = {
    "bash": ["bash", "--noprofile", "--norc", "-i"],
    "zsh": ["zsh", "-f", "-i"],
    "fish": ["fish", "--no-config", "-i"],
}


class Terminal:
    """A shell in a tmux of its own."""

    def __init__(self, shell: str, folder: Path) -> None:
        self.name = f"ur-test-{uuid.uuid4().hex[:8]}"
        script = folder / f"complete.{shell}"
        script.write_text(SCRIPTS[shell])
        (folder / "ur").write_text(f'#!/bin/sh\nexec "{ROOT}/.venv/bin/python" -m ur "$@"\n')
        (folder / "ur").chmod(0o755)
        environment = {
            "PATH": f"{folder}:{os.environ['PATH']}",
            "HOME": str(folder),
            "TERM": "screen",
            "LC_ALL": "C.UTF-8",
            "ROS_PACKAGE_PATH": str(folder),
        }
        self._run("new-session", "-d", "-x", "120", "-y", "40", *STARTS[shell], env=environment, cwd=folder)
        self.type(f". ./complete.{shell}; echo rea''dy", "Enter")
        self.until("ready")

    def type(self, *keys: str) -> None:
        self._run("send-keys", *keys)

    def until(self, text: str) -> str:
        end = time.monotonic() + 60
        while text not in (screen := self.screen()):
            assert time.monotonic() < end, f"waited for {text!r}, saw:\n{screen}"
            time.sleep(0.05)
        return screen

    def screen(self) -> str:
        """Its text, with one blank for several: shells differ in those."""
        return re.sub(" +", " ", self._run("capture-pane", "-p", "-J"))

    def close(self) -> None:
        self._run("kill-server")

    def _run(self, *words: str, env: dict[str, str] | None = None, cwd: Path | None = None) -> str:
        command = ["tmux", "-f", "/dev/null", "-L", self.name, *words]
        return subprocess.run(command, check=True, capture_output=True, text=True, env=env, cwd=cwd, timeout=60).stdout


@pytest.fixture(params=sorted(STARTS))
def terminal(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Terminal]:
    for program in ("tmux", request.param):
        if not shutil.which(program):
            pytest.skip(f"{program} is not installed")
    (tmp_path / "fast.launch").write_text(
        '<launch>\n  <arg name="robot_base"/>\n  <arg name="loud" default="false"/>\n</launch>\n'
    )
    opened = Terminal(request.param, tmp_path)
    yield opened
    opened.close()


def test_tab_completes_verb_file_argument_and_value(terminal: Terminal) -> None:
    terminal.type("ur laun", "Tab")
    terminal.until("ur launch ")
    terminal.type("fas", "Tab")
    terminal.until("ur launch fast.launch ")
    terminal.type("lou", "Tab")
    terminal.until("ur launch fast.launch loud:=")
    terminal.type("tr", "Tab")
    terminal.until("ur launch fast.launch loud:=true")
    terminal.type(" robot_b", "Tab")
    terminal.until("loud:=true robot_base:=")
    terminal.type("mag", "Tab")
    terminal.until("loud:=true robot_base:=magni")
    terminal.type("C-c")


def test_tab_shows_what_there_is(terminal: Terminal) -> None:
    terminal.type("ur run keyboard_", "Tab", "Tab")
    screen = terminal.until("keyboard_drive")
    assert "keyboard_navigate" in screen
    terminal.type("C-c")
