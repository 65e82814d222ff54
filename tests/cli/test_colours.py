"""Colours on a terminal, and none where the user or the terminal has none."""

import os
import pty
from pathlib import Path

import pytest
from tests.forking import python_of_ur

COMMANDS = ["check bad.launch", "help ps", "graph bad.launch", "launch --nodes none.launch", "list", "lanch"]


def run_on_terminal(folder: Path, words: str, **environment: str) -> str:
    """What `ur` writes to a terminal of 100 columns."""
    (folder / "bad.launch").write_text('<launch><node name="a" pkg="p" typ="t"/></launch>\n')
    ours, theirs = pty.openpty()
    own = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "TERM", "FORCE_COLOR")}
    process = python_of_ur().start(
        "ur",
        *words.split(),
        folder=folder,
        environment={**own, "HOME": str(folder), "COLUMNS": "100", **environment},
        streams=(theirs, theirs, theirs),
    )
    os.close(theirs)
    written = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the end of a terminal
            break
        written += piece
    process.wait(60)
    os.close(ours)
    return written.decode()


@pytest.mark.parametrize("environment", [{"TERM": "dumb"}, {"TERM": "xterm-256color", "NO_COLOR": "1"}])
@pytest.mark.parametrize("words", COMMANDS)
def test_no_escape_sequence_where_there_are_no_colours(tmp_path: Path, words: str, environment: dict[str, str]) -> None:
    written = run_on_terminal(tmp_path, words, **environment)
    assert written.strip()
    assert "\x1b" not in written


@pytest.mark.parametrize("words", COMMANDS[:4])
def test_colours_on_a_terminal(tmp_path: Path, words: str) -> None:
    assert "\x1b[" in run_on_terminal(tmp_path, words, TERM="xterm-256color")


def test_help_has_no_frames_on_a_dumb_terminal(tmp_path: Path) -> None:
    assert "─" in run_on_terminal(tmp_path, "help ps", TERM="xterm-256color")
    plain = run_on_terminal(tmp_path, "help ps", TERM="dumb")
    assert not set("─│╭╮╰╯") & set(plain)
    assert "--ended  List the runs" in plain
