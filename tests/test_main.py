"""Ctrl-C at the start of `ur`: no traceback, whenever it comes."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

UR = Path(__file__).parents[1] / "ur"
MARK = UR.parent / ".venv" / "block-signal"


def test_signal_that_waits_since_before_the_start_ends_ur_without_a_word() -> None:
    line = 'kill -INT $$; exec "$@"'  # it is delivered as soon as it is not blocked any more
    done = subprocess.run(
        ["/usr/bin/env", "--block-signal=INT", "bash", "-c", line, "-", sys.executable, "-I", "-m", "ur", "--help"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


@pytest.mark.skipif(not MARK.exists(), reason="env of this computer cannot block signals")
@pytest.mark.parametrize("delay", [0.0, 0.005, 0.01, 0.015, 0.02, 0.03, 0.05, 0.08])  # s
def test_script_that_is_interrupted_prints_no_traceback(delay: float) -> None:
    process = subprocess.Popen([UR, "--help"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert errors == ""
    assert process.returncode in (0, 130, -signal.SIGINT)
