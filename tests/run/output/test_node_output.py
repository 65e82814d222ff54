import os
from collections import deque
from pathlib import Path

import pytest

from ur.run.output.node_output import (
    FLOOD_PIPE,
    KEPT_LINES,
    LONGEST_LINE,
    MOST_READ,
    MOST_SHOWN,
    PERIOD,
    Allowance,
    LineSplitter,
    Stream,
    enlarge_pipe,
    make_printable,
    read_last_lines,
)


def test_lines_are_put_together_from_pieces() -> None:
    lines = LineSplitter()
    assert lines.feed(b"one\ntw") == [b"one"]
    assert lines.feed(b"o\r\n\nthree") == [b"two", b""]
    assert lines.feed(b"") == [b"three"]
    assert lines.feed(b"") == []


def test_endless_line_is_cut() -> None:
    lines = LineSplitter()
    assert lines.feed(b"x" * (2 * LONGEST_LINE + 1)) == [b"x" * LONGEST_LINE] * 2
    assert lines.feed(b"\n") == [b"x"]


def test_skipped_lines_are_counted_and_the_last_ones_are_kept() -> None:
    lines = LineSplitter()
    assert lines.feed(b"begun, ") == []
    assert lines.skip(b"".join(b"%d\r\n" % number for number in range(100)) + b"res", 2) == (100, [b"98", b"99"])
    assert lines.skip(b"t\n", 2) == (1, [b"rest"])
    assert lines.skip(b"x\n" * 3 + b"y" * (LONGEST_LINE + 1), 1) == (4, [b"x"])
    assert lines.feed(b"") == [b"y"]


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        (b"plain \xc3\xa9\ttab", "plain é\ttab"),
        (b"\x1b[31mred\x1b[0m", "\x1b[31mred\x1b[0m"),
        (b"\x1b[2Jcleared \x1b]0;title\x07", "?[2Jcleared ?]0;title?"),
        (b"\xff\x00bin", "\ufffd?bin"),
        (b"end\x1b", "end?"),
    ],
)
def test_only_colours_reach_the_terminal(line: bytes, shown: str) -> None:
    assert make_printable(line) == shown


def test_stream_goes_to_log_people_and_recent_lines(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_CREAT | os.O_WRONLY)
    shown: list[tuple[str, str]] = []
    stream = Stream("/a", reader, log, lambda name, line: shown.append((name, line)))
    recent: deque[str] = deque(maxlen=1)
    os.write(writer, b"one\ntwo")
    assert stream.read(recent)
    assert stream.read(recent)  # nothing there
    os.close(writer)
    assert not stream.read(recent)
    stream.close()
    os.close(log)
    assert shown == [("/a", "one"), ("/a", "two")]
    assert list(recent) == ["two"]
    assert (tmp_path / "log").read_bytes() == b"one\ntwo"


def test_last_lines_of_a_log(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_bytes(b"".join(b"%d\n" % number for number in range(50000)))
    assert read_last_lines(str(log), 3) == ["49997", "49998", "49999"]
    assert read_last_lines(str(tmp_path / "none")) == []


def test_allowance_grows_with_each_period_and_tells_what_was_lost_in_the_last() -> None:
    allowance = Allowance(most=10, more=5, period=1.0)
    assert allowance.spend(8, 5.0) == (8, 0)
    assert allowance.spend(8, 5.9) == (2, 0)
    assert allowance.spend(4, 5.99) == (0, 0)
    assert allowance.spend(4, 6.0) == (4, 10)
    assert allowance.spend(7, 6.1) == (1, 0)
    assert allowance.settle() == 6
    assert allowance.settle() == 0
    assert allowance.spend(20, 8.2) == (10, 0)


def test_flooding_stream_is_logged_in_full_shown_in_part_and_remembered_to_its_end(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT)
    shown: list[str] = []
    now = 100.0
    stream = Stream("/a", reader, log, lambda _, line: shown.append(line), lambda: now)
    recent: deque[str] = deque(maxlen=KEPT_LINES)
    count = MOST_SHOWN + 1000
    for first in range(0, count, 1000):  # less than the pipe holds
        os.write(writer, b"".join(b"%d\n" % number for number in range(first, first + 1000)))
        assert stream.read(recent)
    assert shown == [str(number) for number in range(MOST_SHOWN)]
    assert list(recent) == [str(number) for number in range(count - KEPT_LINES, count)]
    now += PERIOD
    os.write(writer, b"last\n")
    os.close(writer)
    while stream.read(recent):
        pass
    assert shown[MOST_SHOWN:] == ["... 1000 lines are not shown here; the log file has them", "last"]
    assert len((tmp_path / "log").read_bytes().splitlines()) == count + 1
    stream.close()
    os.close(log)


def test_pipe_of_a_flood_is_read_seldom_once_it_holds_enough(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT)
    shown: list[str] = []
    stream = Stream("/a", reader, log, lambda _, line: shown.append(line), lambda: 100.0)
    recent: deque[str] = deque(maxlen=KEPT_LINES)
    os.write(writer, b"x\n" * MOST_SHOWN)
    assert stream.read(recent)
    assert not stream.may_pause  # it may have ended with that
    os.write(writer, b"y\n")
    assert stream.read(recent)
    assert stream.may_pause == (enlarge_pipe(reader) > MOST_READ)  # a user may have only so many large pipes
    if stream.may_pause:
        os.write(writer, b"z\n" * (FLOOD_PIPE // 3))
        assert stream.read(recent)
        assert not stream.may_pause  # it prints faster than that
        assert recent[-1] == "z"
    stream.close()
    os.close(writer)
    os.close(log)


def test_flood_of_long_reads_is_logged_in_full_and_its_lines_are_estimated(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT)
    shown: list[str] = []
    stream = Stream("/a", reader, log, lambda _, line: shown.append(line), lambda: 100.0)
    recent: deque[str] = deque(maxlen=KEPT_LINES)
    os.write(writer, b"x\n" * MOST_SHOWN)
    assert stream.read(recent)
    printed = b"".join(b"%07d\n" % number for number in range(LONGEST_LINE // 4))
    os.write(writer, printed)
    assert stream.read(recent)
    assert recent[-1] == f"{LONGEST_LINE // 4 - 1:07}"
    os.close(writer)
    assert not stream.read(recent)
    assert shown[-1] == f"... about {LONGEST_LINE // 4} lines are not shown here; the log file has them"
    assert (tmp_path / "log").read_bytes() == b"x\n" * MOST_SHOWN + printed
    stream.close()
    os.close(log)


def test_lines_before_a_long_one_are_counted_in_a_flood(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT)
    shown: list[str] = []
    stream = Stream("/a", reader, log, lambda _, line: shown.append(line), lambda: 100.0)
    recent: deque[str] = deque(maxlen=KEPT_LINES)
    os.write(writer, b"x\n" * MOST_SHOWN)
    assert stream.read(recent)
    os.write(writer, b"y\n" * 1000 + b"z" * LONGEST_LINE)
    assert stream.read(recent)
    os.close(writer)
    assert not stream.read(recent)
    assert shown[-1] == "... 1001 lines are not shown here; the log file has them"
    stream.close()
    os.close(log)


def test_stream_that_ends_in_a_flood_tells_what_was_lost(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    log = os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT)
    shown: list[str] = []
    stream = Stream("/a", reader, log, lambda _, line: shown.append(line), lambda: 100.0)
    recent: deque[str] = deque(maxlen=KEPT_LINES)
    os.write(writer, b"x\n" * (MOST_SHOWN + 3))
    os.close(writer)
    while stream.read(recent):
        pass
    assert shown[-1] == "... 3 lines are not shown here; the log file has them"
    stream.close()
    os.close(log)
