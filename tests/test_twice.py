"""tests/twice: what failed runs once more, and what passes only then is recorded."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

_FAKE = """\
#!/bin/bash
mkdir -p .pytest_cache/v/cache
if [[ -e mended ]]; then exit 0; fi
{
  echo '{'
  for name in ${FAILED:-tests/test_a.py::test_b}; do echo "  \\"$name\\": true,"; done
  echo '}'
} >.pytest_cache/v/cache/lastfailed
[[ $LASTING ]] || touch mended
exit 1
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository whose ./test fails once."""
    (tmp_path / "tests").mkdir()
    shutil.copy(Path(__file__).with_name("twice"), tmp_path / "tests" / "twice")
    (tmp_path / "test").write_text(_FAKE)
    (tmp_path / "test").chmod(0o755)
    return tmp_path


def run_twice(tree: Path, lasting: str = "", failed: str = "") -> subprocess.CompletedProcess[str]:
    words = [str(tree / "tests" / "twice"), "tests"]
    environment = {"PATH": "/usr/bin:/bin", "LASTING": lasting, "FAILED": failed}
    return subprocess.run(words, env=environment, capture_output=True, text=True)


def test_test_that_passes_the_second_time_is_recorded_and_shown_by_later_runs(tree: Path) -> None:
    assert run_twice(tree).returncode == 0
    record = (tree / ".cache" / "passed_second_time").read_text()
    assert record.endswith(" unknown tests/test_a.py::test_b\n")
    later = run_twice(tree)
    assert later.returncode == 0
    assert record in later.stdout
    assert (tree / ".cache" / "passed_second_time").read_text() == record


def test_test_that_fails_twice_fails_and_is_not_recorded(tree: Path) -> None:
    assert run_twice(tree, lasting="yes").returncode == 1
    assert not (tree / ".cache").exists()


def test_all_tests_of_one_file_have_a_second_chance_together(tree: Path) -> None:
    assert run_twice(tree, failed=" ".join(f"tests/test_a.py::test_{name}" for name in "bcde")).returncode == 0
    assert (tree / ".cache" / "passed_second_time").read_text().count("tests/test_a.py::") == 4


def test_more_than_three_tests_of_several_files_have_no_second_chance(tree: Path) -> None:
    failed = "tests/test_a.py::test_b tests/test_a.py::test_c tests/test_a.py::test_d tests/test_e.py::test_f"
    assert run_twice(tree, failed=failed).returncode == 1
    assert not (tree / ".cache").exists()
