from __future__ import annotations

import os
from collections import deque
from pathlib import Path

import pytest

from ur.run.output import LONGEST_LINE, LineSplitter, Stream, make_printable, read_last_lines


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
