"""Processes that end with the one that started them, also when that has ended before they could ask for it."""

import os
import subprocess
import sys

import pytest

CHILD = (
    "import sys; from bench.stop_parts.nursery import _die_with_parent as die; die(int(sys.argv[1])); print('lives')"
)


@pytest.mark.parametrize("lives", [True, False])
def test_process_whose_parent_has_ended_already_ends_at_once(lives: bool) -> None:
    if not lives and os.getpid() == 1:
        pytest.skip("the parent is process 1")
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(os.getpid() if lives else 1)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == ((0, "lives\n") if lives else (1, ""))
