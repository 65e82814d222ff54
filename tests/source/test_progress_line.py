import io
import os
import pty
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

import pytest
from tests.fakes.clock import ManualClock
from tests.terminal import TmuxTerminal

from ur.check.session import check_paths
from ur.docs.build import describe_repository
from ur.docs.repository.collect import collect_repository
from ur.launchfile.world import World
from ur.launchfile.world.memory import MemoryWorld
from ur.source.diagnostic import UserError
from ur.source.progress import Progress, counted
from ur.source.progress_line import PLAIN_PERIOD, ProgressLine, show_progress
from ur.tools.find.search import find_name
from ur.tools.package.uses import find_used_packages

ERASE = "\r\x1b[K"


class ReadTerminal:
    """A terminal: what is written to `stream` can be read."""

    def __init__(self) -> None:
        self._master, slave = pty.openpty()
        os.set_blocking(self._master, False)
        self.stream = os.fdopen(slave, "w", encoding="utf-8")
        self.seen = ""

    def read(self) -> str:
        """Everything that was written so far."""
        with suppress(BlockingIOError):
            self.seen += os.read(self._master, 1 << 16).decode()
        return self.seen

    def wait_for(self, text: str) -> None:
        end = time.monotonic() + 60.0
        while text not in self.read():
            assert time.monotonic() < end, f"waited for {text!r}, saw {self.seen!r}"
            time.sleep(0.01)

    def close(self) -> None:
        self.stream.close()
        os.close(self._master)


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Iterator[ReadTerminal]:
    made = ReadTerminal()
    monkeypatch.setenv("TERM", "xterm")
    yield made
    made.close()


@contextmanager
def standard_error(stream: TextIO) -> Iterator[None]:
    # Not in a fixture: pytest sets its own again when the test begins.
    before, sys.stderr = sys.stderr, stream
    try:
        yield
    finally:
        sys.stderr = before


def make_line(out: TextIO, clock: Callable[[], float], term: str = "xterm") -> ProgressLine:
    return ProgressLine(out, "checking 1 of 3 files", 2.0, {"TERM": term}, clock)


def test_line_appears_after_two_seconds_of_silence_and_says_what_is_done() -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock)
    clock.now += 1.9
    line.show()
    assert out.getvalue() == ""
    line.report("checking 2 of 3 files")
    clock.now += 0.2
    line.show()
    assert out.getvalue() == f"{ERASE}checking 2 of 3 files (2 s)"


def test_line_that_says_the_same_is_not_drawn_again() -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock)
    clock.now += 3.0
    line.show()
    clock.now += 0.2
    line.show()
    assert out.getvalue().count("checking") == 1


def test_line_is_erased_before_other_output_and_comes_back_after_two_seconds() -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock)
    clock.now += 3.0
    line.show()
    line.write(out, "formatted a.launch\n")
    drawn = f"{ERASE}checking 1 of 3 files (3 s){ERASE}formatted a.launch\n"
    assert out.getvalue() == drawn
    clock.now += 1.0
    line.show()
    assert out.getvalue() == drawn
    clock.now += 1.0
    line.show()
    assert out.getvalue() == f"{drawn}{ERASE}checking 1 of 3 files (5 s)"


def test_line_that_another_text_has_begun_is_left_alone() -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock)
    line.write(out, "make these changes? [Y/n]: ")
    clock.now += 60.0
    line.show()
    assert out.getvalue() == "make these changes? [Y/n]: "


@pytest.mark.parametrize("term", ["dumb", ""])
def test_terminal_that_cannot_erase_gets_a_line_now_and_then(term: str) -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock, term)
    for _ in range(20):
        clock.now += 1.0
        line.show()
    line.erase()
    shown = [f"checking 1 of 3 files ({second:.0f} s)\n" for second in (2, 2 + PLAIN_PERIOD)]
    assert out.getvalue() == "".join(shown)


def test_foreign_text_in_the_line_does_not_act_on_the_terminal() -> None:
    out, clock = io.StringIO(), ManualClock(100.0)
    line = make_line(out, clock)
    line.report("reading a\x1b]0;x\x07\n.launch")
    clock.now += 3.0
    line.show()
    assert out.getvalue() == f"{ERASE}reading a\\x1b]0;x\\x07\\n.launch (3 s)"


def test_terminal_shows_the_line_and_nothing_of_it_stays(screen: ReadTerminal) -> None:
    with standard_error(screen.stream), show_progress("waiting for bob to answer", quiet=0.0) as report:
        screen.wait_for("waiting for bob to answer (")
        report("reading 1 of 2 answers")
        screen.wait_for("reading 1 of 2 answers (")
        sys.stderr.write("note: bob is renamed\n")
    shown = screen.read().replace("\r\n", "\n")
    before, _, after = shown.partition("note: bob is renamed\n")
    assert before.endswith(ERASE)
    assert after == "" or after.endswith(ERASE)


@pytest.mark.parametrize("problem", [UserError(), KeyboardInterrupt()])
def test_line_ends_with_an_error_and_with_an_interrupt(screen: ReadTerminal, problem: BaseException) -> None:
    def wait() -> None:
        with show_progress("waiting", quiet=0.0):
            screen.wait_for("waiting")
            raise problem

    with standard_error(screen.stream):
        with pytest.raises(type(problem)):
            wait()
        assert sys.stderr is screen.stream
    assert screen.read().endswith(ERASE)
    assert not [thread for thread in threading.enumerate() if thread.name == "progress"]


def test_inner_wait_takes_the_place_of_the_outer_line(screen: ReadTerminal) -> None:
    with standard_error(screen.stream), show_progress("examining the robot", quiet=0.0):
        with show_progress("waiting for bob to answer"):
            screen.wait_for("waiting for bob to answer")
            assert [thread.name for thread in threading.enumerate()].count("progress") == 1
        screen.seen = ""
        screen.wait_for("examining the robot")


def test_nothing_is_shown_where_standard_error_is_no_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with show_progress("checking", quiet=0.0) as report:
        report("checking 1 of 2 files")
        assert not [thread for thread in threading.enumerate() if thread.name == "progress"]
    assert capsys.readouterr() == ("", "")


def test_command_that_is_done_at_once_writes_nothing_to_the_terminal(screen: ReadTerminal) -> None:
    with standard_error(screen.stream), show_progress("checking") as report:
        report("checking 1 of 2 files")
    assert screen.read() == ""


def test_items_are_reported_before_they_are_used() -> None:
    seen: list[str] = []
    for item in counted(["a", "b"], "checking", "files", seen.append):
        seen += [item]
    assert seen == ["checking 1 of 2 files", "a", "checking 2 of 2 files", "b"]


def test_robot_that_does_not_answer_is_named_while_it_is_waited_for(tmp_path: Path) -> None:
    (tmp_path / "ssh").write_text("#!/bin/sh\nexec cat\n")  # connects, and then nothing comes
    (tmp_path / "ssh").chmod(0o755)
    terminal = TmuxTerminal(["bash", "--norc"], tmp_path)
    try:
        terminal.type("PS1='ready> '", "Enter")
        terminal.until("\nready>")
        terminal.type("clear; ur boot status --robot bob", "Enter")
        terminal.until("waiting for bob to answer (")
        terminal.type("C-c")
        terminal.until("ready>")
        terminal.type("echo it is $((40 + 2))", "Enter")
        screen = terminal.until("it is 42")
        assert "waiting for bob" not in screen
    finally:
        terminal.close()


@pytest.mark.parametrize(
    ("work", "last"),
    [
        (lambda world, report: check_paths(["/p"], world, progress=report), "checking 2 of 2 launch files"),
        (lambda world, report: find_name("x", ["/p"], world, progress=report), "searching 2 of 2 launch files"),
        (lambda world, report: find_used_packages("/p", world, report), "checking 2 of 2 launch files"),
        (
            lambda world, report: describe_repository(collect_repository("/p", world, report), report),
            "describing 2 of 2 launch files of p",
        ),
    ],
    ids=["check", "find", "package", "docs"],
)
def test_long_work_reports_how_far_it_is(work: Callable[[World, Progress], object], last: str) -> None:
    manifest = b"<package><name>p</name></package>"
    launch = b"<launch/>"
    world = MemoryWorld({"/p/package.xml": manifest, "/p/a.launch": launch, "/p/b.launch": launch}, {"p": "/p"})
    seen: list[str] = []
    work(world, seen.append)
    assert seen[-1] == last
    assert "reading 1 of 2 launch files" in seen or "checking 1 of 2 launch files" in seen
