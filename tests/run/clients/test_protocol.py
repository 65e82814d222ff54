"""Events and commands as lines: what goes out comes back."""

import pytest

from ur.run.clients.protocol import (
    BadLineError,
    NodeChanged,
    NodeReadiness,
    NodeStats,
    Notice,
    OutputLine,
    RunCommand,
    RunEnded,
    RunEvent,
    RunStarted,
    RunStopping,
    StatsSampled,
    StopRun,
    Synchronised,
    Watch,
    dump_line,
    find_severity,
    parse_command,
    parse_event,
)
from ur.run.supervisor.events import KillNode, RestartNode, StartNode, StopNode

EVENTS: list[RunEvent] = [
    RunStarted("drive.7", 7, "drive", "http://localhost:11311", "/logs", 1.5, detached=True, terminal="/front"),
    NodeChanged("/a", "waiting", None, 3, None, 2, 0.5, "äöü\n", required=True, log="/logs/a.log", program="/a"),
    NodeReadiness("/a", ready=False, missing=("one", "two")),
    OutputLine("/a", "err", "warning", "text\x1b[0m"),
    StatsSampled((NodeStats("/a", 0.5, 1000),)),
    Notice("error", "two\nlines"),
    Synchronised(),
    RunStopping("SIGINT"),
    RunEnded(1),
]
COMMANDS: list[RunCommand] = [
    Watch(output=True),
    StartNode("/a"),
    StopNode("/a"),
    RestartNode("/a"),
    KillNode("/a"),
    StopRun(),
]


@pytest.mark.parametrize("event", EVENTS)
def test_event_comes_back_from_its_line(event: RunEvent) -> None:
    line = dump_line(event)
    assert line.count(b"\n") == 1
    assert parse_event(line) == event


@pytest.mark.parametrize("command", COMMANDS)
def test_command_comes_back_from_its_line(command: RunCommand) -> None:
    assert parse_command(dump_line(command)) == command


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"\xff\n",
        b"[]\n",
        b"{}\n",
        b'{"kind": "Nothing"}\n',
        b'{"kind": "StopNode"}\n',
        b'{"kind": "StopNode", "name": 3}\n',
        b'{"kind": "Watch", "output": 1}\n',
        b'{"kind": ["StopRun"]}\n',
    ],
)
def test_lines_that_are_no_command_are_refused(line: bytes) -> None:
    with pytest.raises(BadLineError):
        parse_command(line)


def test_fields_of_a_newer_version_are_left_out() -> None:
    assert parse_event(b'{"kind": "RunEnded", "exit_code": 3, "mood": "good"}\n') == RunEnded(3)


@pytest.mark.parametrize(
    ("text", "severity"),
    [
        ("[ WARN] [1700000000.1]: low", "warning"),
        ("\x1b[33m[ WARN] [1700000000.1]: low\x1b[0m", "warning"),
        ("[ERROR] [1700000000.1]: no", "error"),
        ("\x1b[31m[FATAL] [1]: no", "fatal"),
        ("[INFO] [1700000000.1]: yes", "info"),
        ("array[INFO]", ""),
        ("plain", ""),
    ],
)
def test_severity_is_what_the_line_says(text: str, severity: str) -> None:
    assert find_severity(text) == severity
