"""The corpus of the fuzzer is replayed, and its limits hold."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.fuzz import worker
from tests.fuzz.target import CORPUS, Target, list_kinds

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("kind", list_kinds())
def test_inputs_of_the_corpus_cause_neither_exceptions_nor_excess(kind: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz.worker", kind, "replay"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert not [line for line in lines if "find" in line]
    assert (done.returncode, lines[-1]["inputs"]) == (0, len(list((CORPUS / kind).glob("*")))), done.stderr


def test_folders_of_the_corpus_are_kinds() -> None:
    assert {path.name for path in CORPUS.iterdir()} <= {*list_kinds()}


def test_undeclared_exception_is_reported_with_its_place(tmp_path: Path) -> None:
    target = Target("broken", lambda data, _: bytearray().append(data[0]))
    found = worker.check_input(target, b"", tmp_path / "folder")
    assert found is not None
    assert found.startswith("IndexError: ")
    assert "test_corpus.py" in found
    assert not (tmp_path / "folder").exists()


def test_input_that_exceeds_the_memory_is_reported(tmp_path: Path) -> None:
    less = worker.read_peak_memory() - 1
    assert "MB" in str(worker.check_input(Target("large", lambda *_: None), b"", tmp_path / "folder", less))


_HANG = """\
import sys
from pathlib import Path
from tests.fuzz import worker
from tests.fuzz.target import Target
worker.CPU_SECONDS, worker.WALL_SECONDS = {cpu}, {wall}
worker.guard_process()
print(worker.check_input(Target("slow", {run}), b"", Path(sys.argv[1]) / "folder"))
"""


@pytest.mark.parametrize(
    ("run", "cpu", "wall", "found"),
    [
        ("lambda *_: [None for _ in iter(int, 1)]", 0.2, 60, "computes for more than"),
        ("lambda *_: __import__('threading').Event().wait()", 60, 0.2, "waits for more than"),
    ],
)
def test_input_that_takes_too_long_is_reported(tmp_path: Path, run: str, cpu: float, wall: float, found: str) -> None:
    script = _HANG.format(run=run, cpu=cpu, wall=wall)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=100,
        check=True,
    )
    assert done.stdout.startswith(found)


def test_find_of_the_command_is_kept_in_the_corpus(tmp_path: Path) -> None:
    code = (
        "import sys, tests.fuzz.__main__ as fuzz; from pathlib import Path\n"
        "tally = fuzz.Tally()\n"
        "line = {'find': 'ValueError: x in a.py:1', 'file': sys.argv[1]}\n"
        "for _ in range(2): fuzz._take(line, 'lease', tally, Path(sys.argv[2]))\n"
        "print(len(tally.finds))"
    )
    (tmp_path / "input").write_bytes(b"x")
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "input"), str(tmp_path / "kept")],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=100,
        check=True,
    )
    assert done.stdout.endswith("1\n")  # the same problem is counted once
    assert [path.read_bytes() for path in (tmp_path / "kept" / "lease").iterdir()] == [b"x"]
