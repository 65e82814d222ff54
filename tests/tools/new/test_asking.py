"""`ur new` on a real terminal asks for what is not given."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.terminal import TmuxTerminal

pytestmark = pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed")


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[TmuxTerminal]:
    opened = TmuxTerminal(["bash", "--noprofile", "--norc", "-i"], tmp_path)
    yield opened
    opened.close()


def test_package_and_group_are_made_by_answering(terminal: TmuxTerminal, tmp_path: Path) -> None:
    terminal.type("ur new package my_robot", "Enter")
    for question, answer in (
        ("What it is for", "Mine."), ("Who looks after it", "Ada"), ("Their address", "ada@here.invalid"),
    ):  # fmt: skip
        terminal.until(question)
        terminal.type(answer, "Enter")
    terminal.until("wrote my_robot/CMakeLists.txt")
    terminal.type("clear; cd my_robot; ur new multi", "Enter")
    for question, answer in (
        ("Name of the directory", "drive"), ("What it starts", "Drive."), ("What it includes", "m_robot_base n_joy"),
    ):  # fmt: skip
        terminal.until(question)
        terminal.type(answer, "Enter")
    terminal.until("wrote bin/ur_drive")
    assert "Ada" in (tmp_path / "my_robot" / "package.xml").read_text()
    assert "n_joy" in (tmp_path / "my_robot" / "m_drive" / "launch" / "m_drive.launch.xml").read_text()


def test_ctrl_c_while_it_asks_writes_nothing(terminal: TmuxTerminal, tmp_path: Path) -> None:
    terminal.type("ur new package my_robot; echo code $?", "Enter")
    terminal.until("What it is for")
    terminal.type("C-c")
    terminal.until("code 130")
    assert not (tmp_path / "my_robot").exists()
