"""Tab in real shells, on a real terminal."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.terminal import TmuxTerminal

from ur.complete.verbs import SCRIPTS

STARTS = {
    "bash": ["bash", "--noprofile", "--norc", "-i"],
    "zsh": ["zsh", "-f", "-i"],
    "fish": ["fish", "--no-config", "-i"],
}


@pytest.fixture(params=sorted(STARTS))
def terminal(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[TmuxTerminal]:
    for program in ("tmux", request.param):
        if not shutil.which(program):
            pytest.skip(f"{program} is not installed")
    (tmp_path / "fast.launch").write_text(
        '<launch>\n  <arg name="robot_base"/>\n  <arg name="loud" default="false"/>\n</launch>\n'
    )
    script = tmp_path / f"complete.{request.param}"
    script.write_text(SCRIPTS[request.param])
    opened = TmuxTerminal(STARTS[request.param], tmp_path)
    opened.type(f". ./{script.name}; echo rea''dy", "Enter")
    opened.until("ready")
    yield opened
    opened.close()


def test_tab_completes_verb_file_argument_and_value(terminal: TmuxTerminal) -> None:
    terminal.type("ur laun", "Tab")
    terminal.until("ur launch ")
    terminal.type("fas", "Tab")
    terminal.until("ur launch fast.launch ")
    terminal.type("lou", "Tab")
    terminal.until("ur launch fast.launch loud:=")
    terminal.type("tr", "Tab")
    terminal.until("ur launch fast.launch loud:=true")
    terminal.type(" robot_b", "Tab")
    terminal.until("loud:=true robot_base:=")
    terminal.type("mag", "Tab")
    terminal.until("loud:=true robot_base:=magni")
    terminal.type("C-c")


def test_tab_shows_what_there_is(terminal: TmuxTerminal) -> None:
    terminal.type("ur run keyboard_", "Tab", "Tab")
    screen = terminal.until("keyboard_drive")
    assert "keyboard_navigate" in screen
    terminal.type("C-c")
