"""Folders and programs that end with their maker, also when that is killed."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from ur.robot.ssh.guard import PipeLines, private_folder, run_guarded
from ur.source import UserError

MAKER = """\
import sys, time
from pathlib import Path
from ur.robot.ssh.guard import private_folder, run_guarded
with private_folder() as folder, run_guarded(["sh", "-c", "echo $$; exec sleep 600"], folder / "log") as program:
    (folder / "file").write_text("x")
    print(folder, program.lines.read(60), flush=True)
    time.sleep(600)
"""


def test_folder_is_private_and_goes_with_the_context(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path) if len(str(tmp_path)) < 60 else "/tmp")
    with private_folder() as folder:
        (folder / "file").write_text("x")
        assert folder.stat().st_mode & 0o777 == 0o700
    assert not folder.exists()


def test_folder_that_cannot_be_made_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", "/proc")
    with pytest.raises(UserError, match="/proc: cannot create a folder there"), private_folder():
        pass


def test_killed_maker_leaves_neither_folder_nor_program() -> None:
    with subprocess.Popen([sys.executable, "-c", MAKER], stdout=subprocess.PIPE, text=True) as maker:
        assert maker.stdout
        folder, number = maker.stdout.readline().split()
        assert Path(folder, "file").exists()
        maker.kill()
    wait_until(lambda: not Path(folder).exists())
    wait_until(lambda: not runs(int(number)))


def test_program_ends_with_the_context_and_its_words_are_kept(tmp_path: Path) -> None:
    command = ["sh", "-c", "echo a word >&2; echo $$; echo ready; exec sleep 600"]
    with run_guarded(command, tmp_path / "log") as program:
        number = int(program.lines.read(60) or 0)
        assert program.wait_for_line("ready", 60)
        assert program.log.read_text() == "a word\n"
        assert runs(number)
    assert not runs(number)


def test_program_that_ends_by_itself_says_no_more(tmp_path: Path) -> None:
    with run_guarded(["sh", "-c", "echo other; exit 3"], tmp_path / "log") as program:
        assert not program.wait_for_line("ready", 60)


def test_lines_that_come_together_are_read_one_by_one_and_with_patience() -> None:
    out, into = os.pipe()
    lines = PipeLines(out)
    os.write(into, b"one\ntwo\nthr")
    assert [lines.read(60), lines.read(60), lines.read(0.01)] == ["one", "two", None]
    os.write(into, b"ee\n")
    os.close(into)
    assert [lines.read(60), lines.read(60)] == ["three", None]
    os.close(out)


def wait_until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in ("Z", "X")
    except (FileNotFoundError, ProcessLookupError):
        return False
