"""The copy of this project on a robot: what is in it, when it is made, and that nobody's changes are lost."""

import base64
import json
import subprocess
import sys
from pathlib import Path

import pytest

from ur.robot.deploy import repository_side
from ur.robot.deploy.repository import (
    COPY,
    READY,
    STAMP,
    WORKSPACE_COPY,
    WantedPrograms,
    WantedRepository,
    read_programs,
    read_repository,
)
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState

ROOT = Path(__file__).parents[3]
WANTED = WantedRepository("digest", {"src/a.py": (0o644, b"1"), "ur": (0o755, b"2"), "bin/ur": (0, b"../ur")})
FOLDER = FileState("", 0o755, folder=True)
KNOWN = {
    "copy": COPY,
    "workspace": WORKSPACE_COPY,
    "stamp": STAMP,
    "ready": f"{COPY}/{READY}",
    "own_ready": f"{WORKSPACE_COPY}/{READY}",
}
COPIED = {"copy": FOLDER, "stamp": FileState("digest\n")}
PROGRAMS = WantedPrograms("d1")
# In place of tools/set_up.bash: says what it was started with, and does what WORK is.
SET_UP = """\
#!/bin/bash
[[ $1 == run ]] || exit 9
work=$(<work)
eval "$work"
"""


def facts(home: str = "/home/ros", /, **files: FileState) -> ComputerFacts:
    found = {path: files.get(key, ABSENT) for key, path in KNOWN.items()}
    return ComputerFacts("ros", home, "bob", "", "", frozenset(), files=found)


@pytest.mark.parametrize(
    ("found", "copied"),
    [
        (facts(), True),
        (facts(copy=FOLDER, stamp=FileState("older\n")), True),
        (facts(copy=FOLDER, stamp=FileState("incomplete\n")), True),
        (facts(copy=FOLDER, stamp=FileState("digest\n")), False),
        (facts(copy=FOLDER), False),  # a clone of the user's own
        (facts(workspace=FOLDER), False),
    ],
)
def test_copy_is_made_unless_it_is_there_or_a_clone_is(found: ComputerFacts, copied: bool) -> None:
    assert (WANTED.plan(found) is not None) is copied


def test_change_does_what_it_says(tmp_path: Path) -> None:
    change = WANTED.plan(facts(str(tmp_path)))
    assert change
    (command,) = change.commands
    assert isinstance(command.stdin, str)
    subprocess.run(["sh", "-c", command.script], input=command.stdin, text=True, check=True, timeout=60)
    copy = tmp_path / "ubiquity_launches"
    assert (copy / "bin/ur").resolve() == copy / "ur"
    assert (copy / "ur").stat().st_mode & 0o777 == 0o755
    assert (copy / ".copy").read_text() == "digest\n"


def put(folder: Path, **texts: str) -> list[str]:
    files = {name: (0o644, base64.b64encode(text.encode()).decode()) for name, text in texts.items()}
    return repository_side.put(folder, "digest", files)


def test_renewed_copy_keeps_what_was_made_and_changed_there(tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    folder.mkdir()
    put(folder, a="1", b="1", gone="1", gone_but_changed="1")
    (folder / ".venv").mkdir()
    (folder / ".venv/x").write_text("environment")
    (folder / "b").write_text("mine")
    (folder / "gone_but_changed").write_text("mine")
    assert put(folder, a="2", b="2") == ["b"]
    assert {each.name: each.read_text() for each in folder.iterdir() if each.is_file() and each.name[0] != "."} == {
        "a": "2",
        "b": "2",
        "gone_but_changed": "mine",
    }
    assert (tmp_path / "copy.changed/b").read_text() == "mine"
    assert (folder / ".venv/x").exists()
    assert put(folder, a="2", b="2") == []


def test_interrupted_copy_is_finished_and_nothing_counts_as_changed(tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    folder.mkdir()
    put(folder, a="1", b="1")
    (folder / "a").write_text("2")  # a run was killed after its first file
    assert put(folder, a="2", b="2") == []
    assert not (tmp_path / "copy.changed").exists()


def test_program_marks_a_copy_before_it_begins(tmp_path: Path) -> None:
    request = {"folder": str(tmp_path / "copy"), "digest": "d", "files": {"a": [0o644, "not base64!"]}}
    words = [sys.executable, "-I", repository_side.__file__]
    subprocess.run(words, input=json.dumps(request), text=True, timeout=60, check=False, capture_output=True)
    assert (tmp_path / "copy/.copy").read_text() == "incomplete\n"


def test_own_repository_has_what_runs_and_nothing_that_was_made() -> None:
    wanted = read_repository(ROOT)
    needed = {"ur", "tools/set_up.bash", "src/ur/cli/main.py", "ubiquity_launches/package.xml", "requirements/run.lock"}
    assert needed <= set(wanted.files)
    assert wanted.files["ubiquity_launches/bin/ur"][0] == 0
    assert not [name for name in wanted.files if "__pycache__" in name or name.startswith((".venv", "tests", ".git"))]
    assert wanted == read_repository(ROOT)
    assert len(repr(wanted)) < 200


@pytest.mark.parametrize(
    ("found", "made"),
    [
        (facts(**COPIED), True),
        (facts(**COPIED, ready=FileState("/home/ros/ubiquity_launches\nd0\n")), True),
        (facts(**COPIED, ready=FileState("/home/ros/ubiquity_launches\n")), True),  # of an earlier version
        (facts(**COPIED, ready=FileState("/home/ros/ubiquity_launches\nd1\n")), False),
        (facts(copy=FOLDER), True),  # a clone of the user's own
        (facts(copy=FOLDER, ready=FileState("elsewhere\n")), False),
        (facts(workspace=FOLDER, **COPIED, ready=FileState("x\nd1\n")), True),
        (facts(workspace=FOLDER, own_ready=FileState("x\n")), False),
    ],
)
def test_environment_is_made_unless_it_is_there_and_of_the_same_files(found: ComputerFacts, made: bool) -> None:
    change = PROGRAMS.plan(found)
    assert (change is not None) is made
    if change:
        place = WORKSPACE_COPY if found.file(WORKSPACE_COPY).folder else COPY
        assert f"cd {found.resolve(place)} " in change.commands[0].script
        assert change.commands[0].fetches


def run_set_up(home: Path, work: str) -> subprocess.CompletedProcess[str]:
    folder = home / "ubiquity_launches"
    (folder / "tools").mkdir(parents=True, exist_ok=True)
    (folder / "tools/set_up.bash").write_text(SET_UP)
    (folder / "work").write_text(work)
    change = PROGRAMS.plan(facts(str(home), **COPIED))
    assert change
    script = change.commands[0].script
    return subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=False, timeout=60)


def test_environment_that_cannot_be_made_is_explained_in_one_line(tmp_path: Path) -> None:
    work = "echo 'setting up'; echo 'error: pip failed'; echo '  | ERROR: no such wheel'; echo 'error: not installed'"
    done = run_set_up(tmp_path, f"{work}; exit 2")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "not installed: no such wheel\n")
    assert run_set_up(tmp_path, "true").returncode == 0


def test_set_up_that_was_left_behind_is_ended_by_the_next(tmp_path: Path) -> None:
    cache = tmp_path / "ubiquity_launches/.cache"
    cache.mkdir(parents=True)
    with subprocess.Popen(["bash", "-c", "read -r _", "set_up.bash"], stdin=subprocess.PIPE) as former:
        (cache / "set_up.pid").write_text(f"{former.pid}\n")
        assert run_set_up(tmp_path, "true").returncode == 0
        assert former.wait(60) == -15


def test_environment_of_a_copy_is_taken_back_and_that_of_a_clone_stays(tmp_path: Path) -> None:
    ready = FileState("x\nd1\n")
    assert PROGRAMS.undo(facts(copy=FOLDER, ready=ready)) is None
    assert PROGRAMS.undo(facts(**COPIED)) is None
    change = PROGRAMS.undo(facts(str(tmp_path), **COPIED, ready=ready))
    assert change
    (tmp_path / "ubiquity_launches/.venv/bin").mkdir(parents=True)
    subprocess.run(["sh", "-c", change.commands[0].script], check=True, timeout=60)
    assert list((tmp_path / "ubiquity_launches").iterdir()) == []


def test_digest_of_the_environment_is_the_one_that_its_set_up_writes() -> None:
    files = 'requirements/run.lock tools/set_up.bash "$source/ur/system/ros_packages.txt" pyproject.toml'
    line = f"cat {files} | sha256sum"
    assert line in (ROOT / "tools/set_up.bash").read_text()
    said = subprocess.run(
        ["sh", "-c", f"source=src; {line}"], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
    ).stdout
    assert read_programs(ROOT).digest == said.split()[0]
