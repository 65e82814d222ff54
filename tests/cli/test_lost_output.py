"""Output that nobody takes and a folder that is gone: one line, and the exit code of convention."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from tests.forking import python_of_ur

ROOT = Path(__file__).parents[2]
UR = shlex.join([sys.executable, "-I", "-m", "ur"])
CALLS = [
    "--version",
    "--help",
    "list",
    "list --help",
    "check a.launch",
    "launch --nodes a.launch",
    "env",
    "graph a.launch",
]
CALLS += [
    "docs . --output -",
    "ps --json",
    "completion zsh",
    "explain a.launch n",
    "use",
    "check --explain bad-eval",
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "a.launch").write_text('<launch><node pkg="p" type="t" name="n"/></launch>')
    return tmp_path


def make_environment(folder: Path) -> dict[str, str]:
    return {"PATH": os.environ["PATH"], "HOME": str(folder), "LC_ALL": "C.UTF-8"}


def run(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment, command = make_environment(folder), ["bash", "-c", line]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("call", CALLS)
def test_full_disk_is_said_in_one_line(folder: Path, call: str) -> None:
    errors = folder / "errors"
    with open("/dev/full", "wb") as full, errors.open("wb") as file:  # noqa: PTH123
        streams = (subprocess.DEVNULL, full.fileno(), file.fileno())
        process = python_of_ur().start(
            "ur", *call.split(), folder=folder, environment=make_environment(folder), streams=streams
        )
        assert process.wait(60) == 2
    said = errors.read_text()
    assert "error: standard output cannot be written: no space left on device" in said.splitlines()
    assert "internal error" not in said
    assert "Exception" not in said


@pytest.mark.parametrize("call", CALLS)
def test_closed_output_is_said_in_one_line(folder: Path, call: str) -> None:
    done = run(f"{UR} {call} >&-", folder)
    assert done.returncode == 2
    assert "error: standard output cannot be written: bad file descriptor" in done.stderr.splitlines()
    assert "internal error" not in done.stderr
    assert "Exception" not in done.stderr


def test_reader_that_has_gone_ends_it_quietly(folder: Path) -> None:
    done = run(f"set -o pipefail; sleep 0.1 | {UR} list | true; echo ${{PIPESTATUS[1]}}", folder)
    assert done.stdout in ("0\n", "141\n")
    assert done.stderr == ""


@pytest.mark.parametrize("how", [">/dev/full", ">&-", "| true"])
def test_answer_to_tab_that_is_lost_says_nothing(folder: Path, how: str) -> None:
    done = run(f"{UR} __complete bash 'ur ' {how}", folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("how", ["2>/dev/full", "2>&-", ">/dev/full 2>&-"])
def test_error_output_that_is_lost_changes_no_exit_code(folder: Path, how: str) -> None:
    assert run(f"{UR} check no.launch {how}", folder).returncode == 2


@pytest.mark.parametrize(
    "call", ["check .", "check a.launch", "find x", "format --check .", "docs .", "launch a.launch"]
)
def test_folder_that_was_deleted_is_said_in_one_line(folder: Path, call: str) -> None:
    (folder / "gone").mkdir()
    done = run(f"cd gone && rmdir ../gone && exec {UR} {call}", folder)
    assert done.returncode in (1, 2)
    assert "internal error" not in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith(("error: ", "a.launch:"))
