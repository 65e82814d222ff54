from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import pytest

from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.exploration.status import Status
from ur_nodes.teleop.explore.explore_progress_node import exit_code, show_exploration
from ur_nodes.teleop.navigator.map_saving_node import MapSaving
from ur_nodes.teleop.terminal.raw import own_terminal


@dataclass
class FakeStatuses:
    newest: Status = field(default_factory=lambda: Status("exploring", 2, 5.0, 8.0))


class FakeMux:
    """A mux that does what it is asked at once."""

    def __init__(self) -> None:
        self.asked: list[MuxRequest] = []

    def view(self) -> MuxView:
        return MuxView(self.asked[-1:] == ["stop"])

    def ask(self, request: MuxRequest) -> None:
        self.asked.append(request)


class FakeMap:
    """A map without anything on it."""

    def lines(self, columns: int, rows: int, now: float) -> list[str]:  # noqa: ARG002 - it never changes
        return ["." * columns] * rows

    def press(self, key: str) -> None:
        """It never changes."""


class Run:
    """The screen of an exploration on a pseudo-terminal."""

    def __init__(self) -> None:
        self.user, self.program = os.openpty()
        self.statuses, self.mux, self.ended = FakeStatuses(), FakeMux(), threading.Event()
        self.saves = 0
        self.thread = threading.Thread(target=self._run)
        self.thread.start()
        os.read(self.user, 65536)  # what is typed before the terminal is in raw mode is lost

    def _save(self) -> str:
        self.saves += 1
        return "map 'flat' saved"

    def _run(self) -> None:
        with own_terminal(self.program, self.program) as terminal:
            saving = MapSaving(self._save, hint="")
            show_exploration(terminal, self.statuses, FakeMap(), self.mux, saving, self.ended)

    def wait(self, holds: Callable[[], bool]) -> None:
        deadline = time.monotonic() + 20.0
        while not holds():
            assert time.monotonic() < deadline
            os.read(self.user, 65536)  # the program draws again and again, so this returns


@pytest.fixture
def run() -> Iterator[Run]:
    started = Run()
    yield started
    started.ended.set()
    with contextlib.suppress(OSError):
        os.write(started.user, b"x")
    started.thread.join(20.0)
    os.close(started.user)
    os.close(started.program)


def test_keys_save_stop_and_release(run: Run) -> None:
    os.write(run.user, b"s r")
    run.wait(lambda: run.mux.asked == ["stop", "release"] and run.saves == 1)


def test_ctrl_c_ends_the_screen(run: Run) -> None:
    os.write(run.user, b"\x03")
    run.thread.join(20.0)
    assert not run.thread.is_alive()


def test_end_of_the_exploration_ends_the_screen(run: Run) -> None:
    run.statuses.newest = Status("complete", known=20.0, saved="flat")
    run.thread.join(20.0)
    assert not run.thread.is_alive()


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (Status("complete", saved="flat"), 0),
        (Status("complete"), 1),
        (Status("incomplete", saved="flat"), 1),
        (Status("stopped", saved="flat"), 130),
        (Status("exploring", saved="flat"), 130),
    ],
)
def test_exit_code_tells_complete_incomplete_and_interrupted_apart(status: Status, code: int) -> None:
    assert exit_code(status) == code
