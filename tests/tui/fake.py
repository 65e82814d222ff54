"""A run that only exists in a test, and services that do nothing."""

import socket
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace

from textual.pilot import Pilot

from ur.run.clients.client import RunClient
from ur.run.clients.protocol import (
    NodeChanged,
    NodeReadiness,
    NodeStats,
    Notice,
    OutputLine,
    RunCommand,
    RunEvent,
    RunStarted,
    StatsSampled,
    Synchronised,
    Watch,
    dump_line,
    find_severity,
    parse_command,
)
from ur.run.clients.run_state import NodeRow
from ur.run.debugger.choice import DebuggerCommand
from ur.tui.app import WatchApp

NOON = 1_700_049_600.0
RUN = RunStarted("m_map.77", 77, "m_map", "http://localhost:11311", "/logs", NOON - 187)


class FakeRun:
    """The supervisor's end of a socket pair, played by the test."""

    def __init__(self) -> None:
        self._link, theirs = socket.socketpair()
        self.control = RunClient(theirs)
        self._heard = b""

    def tell(self, *events: RunEvent) -> None:
        """Something happens."""
        self._link.sendall(b"".join(dump_line(event) for event in events))

    def asked(self) -> list[RunCommand]:
        """Every command so far, `Watch` left out."""
        self._link.setblocking(False)
        try:
            while part := self._link.recv(65536):
                self._heard += part
        except BlockingIOError:
            pass
        finally:
            self._link.setblocking(True)
        found = [parse_command(line) for line in self._heard.splitlines()]
        return [command for command in found if not isinstance(command, Watch)]

    def go(self) -> None:
        """The run is gone."""
        self._link.close()

    def close(self) -> None:
        self._link.close()
        self.control.close()


GDB = DebuggerCommand(("gdb", "-p", "12"), here=True)


@dataclass
class FakeServices:
    """Remembers what it was asked to run."""

    pager: list[str] | None = field(default_factory=lambda: ["less"])
    debugger: DebuggerCommand | str = GDB
    problem: str = ""
    here: list[list[str]] = field(default_factory=list)
    beside: list[list[str]] = field(default_factory=list)
    empty: set[str] = field(default_factory=set)

    def now(self) -> float:
        return NOON

    def has_content(self, path: str) -> bool:
        return path not in self.empty

    def find_pager(self) -> list[str] | None:
        return self.pager

    def run_here(self, words: Sequence[str]) -> str:
        self.here.append(list(words))
        return self.problem

    def run_beside(self, words: Sequence[str]) -> str:
        self.beside.append(list(words))
        return self.problem

    def debug(self, row: NodeRow) -> DebuggerCommand | str:
        assert row.name
        return self.debugger


def line(name: str, text: str) -> OutputLine:
    return OutputLine(name, "out", find_severity(text), text)


def example(*, detached: bool = False) -> list[RunEvent]:
    """A run with a node of every kind."""
    return [
        replace(RUN, detached=detached),
        NodeChanged("/map_server", "running", pid=11, log="/logs/map_server-1-stdout.log"),
        NodeChanged("/amcl", "running", pid=12, log="/logs/amcl-2-stdout.log"),
        NodeChanged("/camera", "ended", exit_code=1, reason="", log="/logs/camera-3-stdout.log"),
        NodeChanged("/lidar", "waiting", signal=11, restarts=2, restart_in=4.0),
        NodeChanged("/rviz", "ended", exit_code=0),
        NodeChanged("/master", "running", pid=10, core=True),
        NodeReadiness("/map_server", ready=True),
        NodeReadiness("/amcl", ready=False, missing=("topic /scan has no publisher",)),
        Synchronised(),
        StatsSampled((NodeStats("/map_server", 0.004, 24_000_000), NodeStats("/amcl", 0.213, 61_300_000))),
        line("/map_server", "[ INFO] [1700000000.100000000]: Read a 312 X 204 map @ 0.050 m/cell"),
        line(
            "/amcl", "\x1b[33m[ WARN] [1700000001.200000000]: No laser scan received (and thus no pose updates)\x1b[0m"
        ),
        line("/camera", "opening /dev/video0"),
        line("/camera", "Traceback (most recent call last):"),
        line("/map_server", "serving"),
        line("/camera", '  File "camera_node", line 5, in <module>'),
        line("/camera", "ModuleNotFoundError: No module named 'picamera'"),
        Notice("error", "/camera died: exit code 1\n  log: /logs/camera-3-stdout.log\n  try: install it"),
    ]


@asynccontextmanager
async def watching(
    *events: RunEvent,
    size: tuple[int, int] = (100, 30),
    services: FakeServices | None = None,
    light: bool = False,
    guest: bool = False,
    early: Sequence[RunEvent] = (),
) -> AsyncIterator[tuple[WatchApp, Pilot[str], FakeRun]]:
    """The interface over a run to which these events have happened (none: the example)."""
    run = FakeRun()
    app = WatchApp(run.control, services or FakeServices(), light=light, guest=guest, early=early)
    try:
        async with app.run_test(size=size) as pilot:
            run.tell(*(events or example()))
            await until(pilot, lambda: bool(app.state.rows) or app.state.exit_code is not None)
            yield app, pilot, run
    finally:
        run.close()


async def until(pilot: Pilot[str], condition: Callable[[], bool], limit: float = 60.0) -> None:
    """Wait until a condition holds."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        await pilot.pause()
        if condition():
            await pilot.pause()
            return
        await pilot.pause(0.02)
    raise AssertionError("it did not come about")


def read_screen(app: WatchApp) -> list[str]:
    """What is on the screen, as text."""
    strips = app.screen._compositor.render_strips(app.screen.size)
    return [strip.text.rstrip() for strip in strips]


def log_of(app: WatchApp) -> str:
    """What is on the screen below the table."""
    screen = read_screen(app)
    start = next(i for i, text in enumerate(screen) if text.startswith("── log"))
    return "\n".join(screen[start:])
