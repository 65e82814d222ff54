"""A program in a tmux pane stays a child of who started it: its keys, its exit code and its end go through."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ur.run.debugger import pane as debug_pane

pytestmark = pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed")


class Tmux:
    def __init__(self, socket: Path) -> None:
        self._socket = str(socket)

    def __call__(self, *words: str) -> str:
        environment = {name: value for name, value in os.environ.items() if name != "TMUX"}
        done = subprocess.run(
            ["tmux", "-S", self._socket, "-f", "/dev/null", *words],
            capture_output=True, text=True, check=False, env=environment, timeout=60,
        )  # fmt: skip
        return done.stdout


@pytest.fixture
def tmux(tmp_path: Path) -> Iterator[Tmux]:
    made = Tmux(tmp_path / "tmux")
    yield made
    made("kill-server")


def until(condition: Callable[[], object], what: Callable[[], str], limit: float = 60.0) -> None:
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, what()
        time.sleep(0.05)


def start(tmux: Tmux, folder: Path, script: str) -> Path:
    """Run a script in a pane; the file gets its exit code."""
    code = folder / "code"
    words = shlex.join([sys.executable, debug_pane.__file__, "name", "bash", "-c", script])
    tmux("new-session", "-d", "-x", "120", "-y", "30", f"{words}; echo $? > {code}.new; mv {code}.new {code}")
    until(lambda: "here" in tmux("capture-pane", "-p", "-t", ":.1"), lambda: tmux("capture-pane", "-p", "-t", ":.1"))
    return code


def test_keys_and_exit_code_go_through(tmux: Tmux, tmp_path: Path) -> None:
    code = start(tmux, tmp_path, "echo here; test -t 0 || exit 9; read word; test $word = hello && exit 3")
    tmux("send-keys", "-t", ":.1", "hello", "Enter")
    until(code.exists, lambda: tmux("capture-pane", "-p", "-t", ":.1"))
    assert code.read_text().strip() == "3"


def test_ctrl_c_in_the_pane_is_a_signal_there(tmux: Tmux, tmp_path: Path) -> None:
    code = start(tmux, tmp_path, "trap 'exit 7' INT; echo here; while :; do sleep 0.1; done")
    tmux("send-keys", "-t", ":.1", "C-c")
    until(code.exists, lambda: tmux("capture-pane", "-p", "-t", ":.1"))
    assert code.read_text().strip() == "7"


def test_closed_pane_ends_the_program(tmux: Tmux, tmp_path: Path) -> None:
    code = start(tmux, tmp_path, "echo here; exec sleep 600")
    tmux("kill-pane", "-t", ":.1")
    until(code.exists, lambda: "it still runs")
    assert code.read_text().strip() == str(128 + 1)


def test_program_joins_the_terminal_that_waits_for_it(tmux: Tmux, tmp_path: Path) -> None:
    address = f"{tmp_path}/made/join"
    waiting = shlex.join([sys.executable, debug_pane.__file__, "--wait", address, "/a"])
    tmux("new-session", "-d", "-x", "120", "-y", "30", f"{waiting}; exec cat")
    until(lambda: "waiting until /a" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"), 60.0)
    words = [sys.executable, debug_pane.__file__, "--join", address, "/a", "bash", "-c"]
    process = subprocess.Popen([*words, "test -t 0 && echo joined $TERM; read word; exit ${#word}"])
    try:
        until(lambda: "joined" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"), 60.0)
        assert "joined screen" in tmux("capture-pane", "-p") or "joined tmux" in tmux("capture-pane", "-p")
        tmux("send-keys", "hello", "Enter")
        assert process.wait(60) == 5
    finally:
        process.kill()
        process.wait()
    assert not Path(address).parent.exists()


def test_nobody_to_join_is_an_error(tmp_path: Path, capfd: Any) -> None:
    assert debug_pane.main(["--join", f"{tmp_path}/none", "/a", "true"], 0.0) == 1
    assert "no terminal waits to debug it" in capfd.readouterr().err


@pytest.mark.skipif(shutil.which("gdb") is None, reason="gdb is not installed")
def test_process_that_is_killed_while_gdb_holds_it_ends_gdb(tmux: Tmux) -> None:
    held = subprocess.Popen(["sleep", "600"])
    try:
        words = [sys.executable, debug_pane.__file__, "--attach", str(held.pid)]
        tmux("new-session", "-d", "-x", "120", "-y", "30",
             shlex.join([*words, "gdb", "-q", "-nx", "-p", str(held.pid)]) + "; echo ended; exec cat")  # fmt: skip
        until(lambda: "(gdb)" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"), 60.0)
        held.kill()
        until(lambda: "ended" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"), 60.0)
        assert held.wait(60) == -9
    finally:
        held.kill()
        held.wait()
