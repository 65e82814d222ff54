"""`ur run PROGRAM --web`: program and page begin and end together."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, make_environment

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")
pytestmark = [pytest.mark.ros, pytest.mark.long, pytest.mark.timeout(300)]

UR = str(ROOT / "ur")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_page_and_program_end_together(tmp_path: Path, number: signal.Signals) -> None:
    environment = make_environment(tmp_path) | {"XDG_STATE_HOME": str(tmp_path / "state")}

    def list_runs() -> str:
        done = subprocess.run([UR, "ps"], env=environment, capture_output=True, text=True, timeout=120, check=True)
        return done.stdout

    def wait(*, active: bool) -> None:
        deadline = time.monotonic() + 100.0
        while ("m_robot_base" in list_runs()) != active:
            assert time.monotonic() < deadline, log.read_text()

    log = tmp_path / "log"
    with log.open("w") as output:
        command = [UR, "run", "robot_base", "--web", "world:=office"]
        process = subprocess.Popen(
            command, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd=tmp_path
        )
    wait(active=True)
    assert "login#" in log.read_text()
    process.send_signal(number)
    assert process.wait(120) == (0 if number == signal.SIGINT else -number)
    wait(active=False)
