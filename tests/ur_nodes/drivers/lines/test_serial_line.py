"""The serial line on pseudo-terminals: opened again after it was unplugged, with a guard."""

import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.ur_nodes.drivers.threads import ThreadedNode

from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SerialLine
from ur_nodes.simulator.devices.bench import DeviceTerminal

WAIT = 20.0  # s


class Record:
    """What a line has reported."""

    def __init__(self) -> None:
        self.events: list[Any] = []
        self.changed = threading.Condition()

    def user(self) -> LineUser:
        return LineUser(lambda: self.add("open"), lambda data, stamp: self.add((data, stamp)), self.add)

    def add(self, event: Any) -> None:
        with self.changed:
            self.events.append(event)
            self.changed.notify_all()

    def wait(self, condition: Callable[[list[Any]], bool]) -> None:
        with self.changed:
            assert self.changed.wait_for(lambda: condition(self.events), WAIT), self.events


def read_until(terminal: DeviceTerminal, end: bytes) -> bytes:
    data = b""
    wait = threading.Event()
    for _ in range(int(WAIT / 0.01)):
        data += terminal.read()
        if data.endswith(end):
            return data
        wait.wait(0.01)
    raise AssertionError(data)


def test_line_is_opened_when_the_device_is_there_and_again_when_it_is_back(tmp_path: Path) -> None:
    path, record = tmp_path / "device", Record()
    line = SerialLine(ThreadedNode(), str(path), record.user(), LineSettings(115200))  # type: ignore[arg-type]
    record.wait(lambda events: events == ["no such file or directory"])
    for _ in range(2):
        terminal = DeviceTerminal(path)
        record.wait(lambda events: events[-1] == "open")
        terminal.write(b"counts")
        record.wait(lambda events: events[-1] == (b"counts", 7))
        line.write(b"speeds")
        assert read_until(terminal, b"speeds") == b"speeds"
        seen = len(record.events)
        terminal.close()
        record.wait(lambda events, seen=seen: bool({*events[seen:]} & {"it was unplugged", "input/output error"}))  # type: ignore[misc]
    line.close()


def test_device_that_is_in_use_is_reported_and_used_once_it_is_free(tmp_path: Path) -> None:
    terminal, first, second = DeviceTerminal(tmp_path / "device"), Record(), Record()
    one = SerialLine(ThreadedNode(), str(terminal.path), first.user(), LineSettings(115200))  # type: ignore[arg-type]
    first.wait(lambda events: events == ["open"])
    other = SerialLine(ThreadedNode(), str(terminal.path), second.user(), LineSettings(115200))  # type: ignore[arg-type]
    second.wait(lambda events: len(events) == 1 and events[0] != "open")
    one.close()
    second.wait(lambda events: events[-1] == "open")
    other.close()
    terminal.close()


def test_guard_that_was_killed_is_started_again(tmp_path: Path) -> None:
    started: list[int] = []

    def start_guard(device: int, _stop: bytes, _leave: bytes) -> tuple[int, int]:
        """One that was killed at once: the end of a pipe that none reads."""
        started.append(device)
        theirs, ours = os.pipe()
        os.close(theirs)
        return ours, 0

    terminal, record = DeviceTerminal(tmp_path / "device"), Record()
    line = SerialLine(ThreadedNode(), str(terminal.path), record.user(), LineSettings(115200, b"STOP"), start_guard)  # type: ignore[arg-type]
    record.wait(lambda events: events == ["open"])
    line.write(b"go", moving=True)
    assert len(started) == 2
    line.close()
    terminal.close()


def test_what_stops_the_motors_is_sent_where_no_guard_can_be_started(tmp_path: Path) -> None:
    pipes: list[int] = []

    def start_guard(_device: int, _stop: bytes, _leave: bytes) -> tuple[int, int]:
        """One that was killed at once, and none after it."""
        if pipes:
            raise OSError
        theirs, ours = os.pipe()
        os.close(theirs)
        pipes.append(ours)
        return ours, 0

    terminal, record = DeviceTerminal(tmp_path / "device"), Record()
    line = SerialLine(ThreadedNode(), str(terminal.path), record.user(), LineSettings(115200, b"STOP"), start_guard)  # type: ignore[arg-type]
    record.wait(lambda events: events == ["open"])
    line.write(b"go", moving=True)
    line.write(b"stop")
    line.close()
    assert read_until(terminal, b"stop") == b"STOPstop"
    terminal.close()
