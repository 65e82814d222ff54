"""Resuming, crashes, Ctrl-C and the table of the runner of host tests, with small files in their place."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MIXED = """
import pytest
pytestmark = pytest.mark.hosts
def test_good(): pass
def test_bad(): assert False
@pytest.fixture
def broken(): raise OSError
def test_without_its_fixture(broken): pass
@pytest.mark.skip
def test_left_out(): pass
"""
GOOD = "import pytest\n@pytest.mark.hosts\ndef test_good():\n    open({log!r}, 'a').write('ran ')\n"
CRASH = "import os, pytest\n@pytest.mark.hosts\ndef test_crash():\n    os.kill(os.getpid(), 9)\n"
SLOW = """
import pathlib, time, pytest
@pytest.fixture
def computer():
    pathlib.Path({log!r}).write_text("booted")
    yield
    pathlib.Path({log!r}).write_text("removed")
@pytest.mark.hosts
def test_slow(computer): time.sleep(600)
"""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "log"


def write(folder: Path, name: str, text: str) -> str:
    path = folder / f"test_{name}.py"
    path.write_text(text.format(log=str(folder / "log")) if "{log" in text else text)
    return str(path)


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    command: Sequence[str] = [sys.executable, str(ROOT / "tools" / "run_host_tests.py"), *arguments]
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    environment = kept | {"XDG_CACHE_HOME": str(folder / "cache"), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def run(folder: Path, *arguments: str) -> tuple[int, str]:
    with start(folder, *arguments) as process:
        output, _ = process.communicate(timeout=100)
    return process.returncode, output


def find_row(output: str, name: str) -> list[str]:
    return next(line.split()[1:] for line in reversed(output.splitlines()) if line.partition(" ")[0] == name)


def test_table_counts_each_result_and_names_what_failed(tmp_path: Path) -> None:
    name = write(tmp_path, "mixed", MIXED)
    code, output = run(tmp_path, name)
    assert code == 1
    assert find_row(output, name)[:4] == ["4", "1", "2", "1"]
    assert f"failed: {name}::test_bad" in output
    assert f"failed: {name}::test_without_its_fixture" in output
    assert output.splitlines()[-1] == "1 passed, 2 failed, 1 skipped"


def test_file_that_passed_is_left_out_until_again_is_given(tmp_path: Path, log: Path) -> None:
    names = write(tmp_path, "good", GOOD), write(tmp_path, "mixed", MIXED)
    assert run(tmp_path, *names)[0] == 1
    code, output = run(tmp_path, *names)
    assert code == 1
    assert "passed earlier" in output
    assert output.count("\n== ") == 1
    assert log.read_text() == "ran "
    assert run(tmp_path, "--again", names[0])[0] == 0
    assert log.read_text() == "ran ran "


def test_file_is_run_again_with_other_options(tmp_path: Path, log: Path) -> None:
    name = write(tmp_path, "good", GOOD)
    assert run(tmp_path, name, "-kgood")[0] == 0
    assert run(tmp_path, name)[0] == 0
    assert log.read_text() == "ran ran "


def test_name_of_no_file_is_refused_before_anything_runs(tmp_path: Path, log: Path) -> None:
    code, output = run(tmp_path, write(tmp_path, "good", GOOD), "test_nothing.py")
    assert code == 2
    assert '"test_nothing.py"' in output
    assert not log.exists()


def test_crash_ends_one_file_only(tmp_path: Path, log: Path) -> None:
    names = write(tmp_path, "crash", CRASH), write(tmp_path, "good", GOOD)
    code, output = run(tmp_path, *names)
    assert code == 1
    assert log.read_text() == "ran "
    assert "pytest ended with signal SIGKILL" in output
    assert output.splitlines()[-1] == "1 passed, 1 failed, 0 skipped"


def test_interrupt_removes_what_the_file_made_and_prints_the_table(tmp_path: Path, log: Path) -> None:
    names = write(tmp_path, "good", GOOD), write(tmp_path, "slow", SLOW), write(tmp_path, "after", GOOD)
    with start(tmp_path, *names) as process:
        end = time.monotonic() + 60
        while not log.exists() or log.read_text() != "booted":
            assert time.monotonic() < end
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=100)
    assert process.returncode == 130
    assert log.read_text() == "removed"
    assert "not run: 2 files" in output
    assert output.splitlines()[-1] == "1 passed, 0 failed, 0 skipped"
