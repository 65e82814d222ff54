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
printf '{\\n  "tests/test_a.py::test_b": true\\n}' >.pytest_cache/v/cache/lastfailed
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


def run_twice(tree: Path, lasting: str = "") -> subprocess.CompletedProcess[str]:
    words = [str(tree / "tests" / "twice"), "tests"]
    return subprocess.run(words, env={"PATH": "/usr/bin:/bin", "LASTING": lasting}, capture_output=True, text=True)


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
