"""tests/twice: what failed runs once more, and what passes only then is recorded."""

import shutil
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path

import pytest
from tools.second_tries import read_entries

ROOT = Path(__file__).parents[1]
_FAKE = """\
#!/bin/bash
printf '%s\\n' "$*" >>arguments
mkdir -p .pytest_cache/v/cache
if [[ -e mended ]]; then exit 0; fi
{
  comma=''
  echo '{'
  for name in ${FAILED:-tests/test_a.py::test_b}; do printf '%b  "%s": true' "$comma" "$name" && comma=',\\n'; done
  printf '\\n}'
} >.pytest_cache/v/cache/lastfailed
[[ $LASTING ]] || touch mended
exit 1
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository whose ./test fails once."""
    for name in ("tests/twice", "tools/second_tries.py"):
        (tmp_path / name).parent.mkdir()
        shutil.copy(ROOT / name, tmp_path / name)
    for name, text in (("test", _FAKE), (".venv/bin/python", f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    return tmp_path


def run_twice(tree: Path, *arguments: str, lasting: str = "", failed: str = "") -> subprocess.CompletedProcess[str]:
    words = [str(tree / "tests" / "twice"), *(arguments or ["tests"])]
    environment = {"PATH": "/usr/bin:/bin", "LASTING": lasting, "FAILED": failed}
    return subprocess.run(words, env=environment, capture_output=True, text=True)


def read_record(tree: Path) -> list[str]:
    return list(read_entries((tree / "tests" / "second_tries.yaml").read_text()))


def test_test_that_passes_the_second_time_is_recorded_and_its_line_printed(tree: Path) -> None:
    before = datetime.now(timezone.utc).date()
    done = run_twice(tree)
    assert done.returncode == 0, done.stderr
    record = (tree / "tests" / "second_tries.yaml").read_text()
    ((test, day),) = read_entries(record).items()
    assert test == "tests/test_a.py::test_b"
    assert before <= day <= datetime.now(timezone.utc).date()
    assert f'"{test}": {day}' in done.stdout.splitlines()


def test_second_try_selects_what_the_first_did_and_looks_at_types_where_that_did(tree: Path) -> None:
    for name in ("ruff", "mypy"):
        (tree / ".venv" / "bin" / name).symlink_to("/bin/true")
    assert run_twice(tree, "--all", "--times=t").returncode == 0
    first, second = (tree / "arguments").read_text().splitlines()
    assert first == "--all --times=t"
    assert second.startswith("-n 0 -m not hosts and not nightly --times=t -n 0 --last-failed")
    (tree / "mended").unlink()
    (tree / ".venv" / "bin" / "mypy").unlink()
    (tree / ".venv" / "bin" / "mypy").symlink_to("/bin/false")
    assert run_twice(tree, "--all").returncode == 1


def test_test_that_fails_twice_fails_and_is_not_recorded(tree: Path) -> None:
    assert run_twice(tree, lasting="yes").returncode == 1
    assert not (tree / "tests" / "second_tries.yaml").exists()


def test_all_tests_of_six_files_have_a_second_chance_together(tree: Path) -> None:
    tests = [f"tests/test_{name}.py::test_{number}" for name in "abcdef" for number in range(6)]
    assert run_twice(tree, failed=" ".join(tests)).returncode == 0
    assert read_record(tree) == tests


@pytest.mark.parametrize(("files", "each"), [(7, 2), (1, 41)])
def test_more_than_twelve_tests_of_seven_files_or_forty_have_no_second_chance(
    tree: Path, files: int, each: int
) -> None:
    failed = " ".join(f"tests/test_{name}.py::test_{number}" for name in range(files) for number in range(each))
    assert run_twice(tree, failed=failed).returncode == 1
    assert not (tree / "tests" / "second_tries.yaml").exists()


def test_twelve_tests_of_several_files_have_a_second_chance(tree: Path) -> None:
    tests = [f"tests/test_{number:02}.py::test_a" for number in range(12)]
    assert run_twice(tree, failed=" ".join(tests)).returncode == 0
    assert read_record(tree) == tests
