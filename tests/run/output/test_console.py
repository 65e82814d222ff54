import os
from collections.abc import Iterator

import pytest

from ur.run.output.console import MOST_WAITING, Console


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    reader, writer = os.pipe()
    os.set_blocking(reader, False)
    yield reader, writer
    os.close(reader)
    os.close(writer)


def read_all(console: Console, reader: int) -> str:
    data = b""
    while True:
        console.flush()
        try:
            data += os.read(reader, 65536)
        except BlockingIOError:
            return data.decode()


def test_lines_carry_the_name_of_their_node(pipe: tuple[int, int]) -> None:
    console = Console(pipe[1], pipe[1])
    console.show("/a", "one")
    console.inform("note")
    console.show_error("/b", "two")
    assert read_all(console, pipe[0]) == "[/a] one\nnote\n[/b] two\n"


@pytest.mark.parametrize(
    ("environment", "painted"),
    [({"TERM": "xterm"}, True), ({"TERM": "xterm", "NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)],
)
def test_terminal_gets_colours_unless_it_or_the_user_has_none(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str], painted: bool
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    ours, theirs = os.openpty()
    os.set_blocking(ours, False)
    try:
        console = Console(theirs, theirs)
        console.inform("note")
        console.fail("died")
        console.show("/a", "one")
        text = read_all(console, ours)
        assert text.count("\n") == 3
        assert ("\x1b" in text) is painted
    finally:
        os.close(ours)
        os.close(theirs)


def test_only_an_error_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    ours, theirs = os.openpty()
    os.set_blocking(ours, False)
    try:
        console = Console(theirs, theirs)
        console.warn("error: as a node wrote it")
        console.fail("died")
        warned, failed = read_all(console, ours).splitlines()
        assert warned == "error: as a node wrote it"
        assert failed.startswith("\x1b[")
        assert "error: died" in failed
    finally:
        os.close(ours)
        os.close(theirs)


def test_held_console_keeps_what_matters(pipe: tuple[int, int]) -> None:
    console = Console(pipe[1], pipe[1])
    console.hold()
    console.inform("started")
    console.fail("died")
    assert read_all(console, pipe[0]) == ""
    console.release()
    assert read_all(console, pipe[0]) == "error: died\n"


def test_reader_that_does_not_read_holds_nothing_up(pipe: tuple[int, int]) -> None:
    console = Console(pipe[1], pipe[1])
    for number in range(3 * MOST_WAITING):
        console.show("/a", f"line {number} {'x' * 60}")
        console.flush()
    console.fail("important")
    text = read_all(console, pipe[0])
    assert "lines are not shown here; the log files have them\n" in text
    assert text.endswith("error: important\n")
    assert console.waiting() == []


def test_reader_that_has_gone_is_no_error() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    console = Console(writer, writer)
    console.show("/a", "one")
    console.finish(1.0)
    assert console.waiting() == []
    os.close(writer)
