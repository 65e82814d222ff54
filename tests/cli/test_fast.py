from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from ur.cli.fast import launch_fast, read_plain
from ur.request.options import Query

SOURCE = str(Path(__file__).parents[2] / "src")


@pytest.mark.parametrize(
    ("line", "question"),
    [
        ("launch --nodes a.launch", (["a.launch"], ("nodes", None))),
        ("launch p a.launch x:=1 --files", (["p", "a.launch", "x:=1"], ("files", None))),
        ("launch --args /n a.launch x:=-1", (["a.launch", "x:=-1"], ("args", "/n"))),
        ("launch --nodes", None),
        ("launch --nodes --files a.launch", None),
        ("launch --nodes -", None),
        ("launch --args a.launch", None),
        ("launch --args=/n a.launch", None),
        ("launch --nodes a.launch --help", None),
        ("launch --node a.launch", None),
        ("check --nodes a.launch", None),
    ],
)
def test_only_plain_questions_are_taken(line: str, question: tuple[list[str], Query] | None) -> None:
    assert read_plain(line.split()) == question


def _run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder), "PYTHONPATH": SOURCE}
    command = [sys.executable, "-X", "importtime", "-m", "ur", *words]
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=60, check=False)


def test_plain_question_is_answered_without_click(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text('<launch><node pkg="p" type="t" name="n"/></launch>')
    done = _run(["launch", "--nodes", str(tmp_path / "a.launch")], tmp_path)
    assert (done.returncode, done.stdout) == (0, "/n\n")
    for heavy in ("click", "yaml", "ur.run", "ur.launchfile.dump", "ur.launchfile.plan.values.expression"):
        assert f" {heavy}\n" not in done.stderr


def test_what_is_wrong_is_said_once_and_as_ever(tmp_path: Path) -> None:
    (tmp_path / "a.launch").write_text('<launch><node pkg="p" type="t" name="$(arg no)"/></launch>')
    refused = _run(["launch", "--nodes", str(tmp_path / "a.launch")], tmp_path)
    assert refused.returncode == 1
    assert refused.stderr.count("argument 'no' is not declared") == 1
    missing = _run(["launch", "--nodes", str(tmp_path / "b.launch")], tmp_path)
    assert missing.returncode == 1  # as roslaunch
    assert missing.stderr.count("expected a launch file") == 1


def test_plain_launch_needs_no_click_and_says_what_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "bad.launch").write_text("<launch><node/></launch>")
    done = _run(["launch", str(tmp_path / "bad.launch")], tmp_path)
    assert done.returncode == 1
    assert "bad.launch:1:9: error: " in done.stderr
    assert not [line for line in done.stderr.splitlines() if line.startswith("import time:") and "click" in line]


def test_launch_without_options_is_taken() -> None:
    assert read_plain(["launch", "p", "a.launch", "x:=1"]) == (["p", "a.launch", "x:=1"], None)


def test_launch_with_an_option_is_left_to_click() -> None:
    assert launch_fast(["launch", "a.launch", "--plain"]) is None
    assert launch_fast(["launch", "-"]) is None
    assert launch_fast(["launch"]) is None
    assert launch_fast(["check", "a.launch"]) is None
