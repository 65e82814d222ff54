"""The serial line, job by job: bytes before it is open, a full pipe to its guard, and its end while a job runs."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ur_nodes.drivers.pipes import fill_pipe, open_pipe, read_rest

from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SerialLine
from ur_nodes.simulator.devices.bench import DeviceTerminal


class QueuedNode:
    """The part of a node that a serial line needs; a job runs when the test says so."""

    def __init__(self) -> None:
        self.jobs: list[tuple[Callable[[], Any], Callable[[Any], None]]] = []
        self.timers: list[float] = []

    def work(self, job: Callable[[], Any], callback: Callable[[Any], None], _lane: str = "") -> None:
        self.jobs.append((job, callback))

    def after(self, seconds: float, _call: Callable[[], None], *, steady: bool = False) -> None:
        assert steady
        self.timers.append(seconds)

    def now(self) -> int:
        return 7

    def run(self) -> Any:
        """Run the oldest job, and give its result to the line."""
        job, take = self.jobs.pop(0)
        result = job()
        take(result)
        return result


class FullGuard:
    """A guard that reads nothing, with a pipe that is full."""

    def __init__(self) -> None:
        self.pipe, self.size = -1, 0

    def start(self, _device: int, _stop: bytes, _leave: bytes) -> tuple[int, int]:
        self.pipe, ours = open_pipe()
        self.size = fill_pipe(ours)
        return ours, 0


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[DeviceTerminal]:
    device = DeviceTerminal(tmp_path / "device")
    yield device
    device.close()


def make_line(path: Path, **arguments: Any) -> tuple[SerialLine, QueuedNode, list[Any]]:
    """A line with its node, and what it reports."""
    node, events = QueuedNode(), list[Any]()
    user = LineUser(lambda: events.append("open"), lambda data, stamp: events.append((data, stamp)), events.append)
    return SerialLine(node, str(path), user, **arguments), node, events  # type: ignore[arg-type]


def test_bytes_before_the_device_is_open_are_dropped(terminal: DeviceTerminal) -> None:
    line, node, events = make_line(terminal.path, settings=LineSettings(115200))
    line.write(b"early")
    node.run()
    assert events == ["open"]
    line.write(b"")
    line.write(b"late")
    assert read_bytes(terminal, 4) == b"late"
    line.close()


def test_bytes_reach_the_device_while_the_pipe_of_the_guard_is_full(terminal: DeviceTerminal) -> None:
    guard = FullGuard()
    line, node, _ = make_line(terminal.path, settings=LineSettings(115200, b"STOP"), guard=guard.start)
    node.run()
    line.write(b"speeds", moving=True)
    assert read_bytes(terminal, 6) == b"speeds"
    line.close()
    assert read_rest(guard.pipe) == bytes(guard.size)
    os.close(guard.pipe)


def test_device_that_is_opened_after_the_end_is_closed_again_and_not_reported(terminal: DeviceTerminal) -> None:
    line, node, events = make_line(terminal.path, settings=LineSettings(115200))
    line.close()
    assert not node.run().is_open
    assert (events, node.jobs, node.timers) == ([], [], [])


def test_device_that_cannot_be_opened_is_tried_again_only_until_the_end(tmp_path: Path) -> None:
    line, node, events = make_line(tmp_path / "away", settings=LineSettings(115200))
    node.run()
    assert (events, len(node.timers)) == (["no such file or directory"], 1)
    line._open()  # as the timer does
    line.close()
    node.run()
    assert (events, len(node.timers)) == (["no such file or directory"], 1)
    line._open()
    assert node.jobs == []


def test_device_that_sends_nothing_is_read_on_and_reports_nothing(terminal: DeviceTerminal) -> None:
    line, node, events = make_line(terminal.path, settings=LineSettings(115200))
    node.run()
    assert node.run().lost == ""
    assert (events, len(node.jobs)) == (["open"], 1)
    terminal.write(b"counts")
    node.run()
    assert events[1:] == [(b"counts", 7)]
    line.close()


def read_bytes(terminal: DeviceTerminal, count: int) -> bytes:
    """Wait for so many bytes that the line has sent."""
    os.set_blocking(terminal._ours, True)
    data = b""
    while len(data) < count:
        data += terminal.read()
    return data
