"""The count on the terminal while a program that takes it is loaded."""

import fcntl
import os
import select
import struct
import subprocess
import sys
import termios
from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

import pytest

from ur.run.output.console import Console
from ur.run.process.terminal import Terminal
from ur.run.startup.progress import StartCount

PILOT = "import sys; sys.stdin.readline(); print('here', flush=True); sys.stdin.readline()"
LINE = "pilot takes this terminal in a few seconds"


@dataclass
class LentTerminal:
    """A terminal that is lent; the real one is tried with `ur launch`."""

    unused: bool = True

    def is_unused(self, _group: int) -> bool:
        return self.unused


class Start:
    """A count on a screen of 100 columns, and the program that it waits for, which prints when a line comes."""

    def __init__(self) -> None:
        self._screen, end = os.openpty()
        fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
        self.terminal, self.console, self.now = LentTerminal(), Console(end, end), 0.0
        self.count = StartCount("/ns/pilot", 3, cast("Terminal", self.terminal), self.console)
        self.console.hold()
        self.program = subprocess.Popen(
            [sys.executable, "-I", "-c", PILOT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._files = (self._screen, end)

    def work(self, *up: str) -> str:
        """Have these nodes up and the count do its work; return what is new on the screen."""
        for name in up:
            self.count.note(name, up=True)
        for _ in range(2):
            self.now += 1.0
            self.count.work(self.now)
        shown = b""
        while select.select([self._screen], [], [], 0)[0]:
            shown += os.read(self._screen, 4096)
        return shown.decode()

    def close(self) -> None:
        self.program.communicate("")
        for file in self._files:
            os.close(file)


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Start]:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    start = Start()
    assert f"starting: {LINE}" in start.work()
    start.count.begin(start.program.pid, start.now)
    yield start
    start.close()


def test_count_changes_in_place_while_the_program_has_written_nothing(start: Start) -> None:
    assert start.work() == ""  # nothing is up
    first = start.work("/a")
    assert f"starting: 1 of 3 up; {LINE}" in first
    assert first.startswith("\x1b7\x1b[A\r")
    assert first.endswith("\x1b[K\x1b8")
    assert start.work() == ""  # nothing has changed
    assert "2 of 3 up" in start.work("/a", "/b")
    assert start.count.due is not None


def test_count_ends_with_the_first_that_the_program_writes(start: Start) -> None:
    assert "1 of 3 up" in start.work("/a")
    assert start.program.stdin is not None
    assert start.program.stdout is not None
    start.program.stdin.write("\n")
    start.program.stdin.flush()
    assert start.program.stdout.readline() == "here\n"
    assert start.work("/b") == ""
    assert start.count.due is None


def test_count_ends_when_something_else_was_printed(start: Start) -> None:
    assert "1 of 3 up" in start.work("/a")
    start.console.release()
    start.console.warn("something else")
    start.console.flush()
    assert "up" not in start.work("/b")
    assert start.count.due is None


def test_count_ends_when_the_terminal_is_used(start: Start) -> None:
    start.terminal.unused = False
    assert start.work("/a") == ""
    assert start.count.due is None


def test_count_of_a_program_that_has_ended_ends(start: Start) -> None:
    start.program.communicate("")
    assert start.work("/a") == ""
    assert start.count.due is None
