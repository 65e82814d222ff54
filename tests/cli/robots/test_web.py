"""`ur web`: where it listens."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")


def test_page_for_phones_needs_its_port_on_all_addresses(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.2", 0))  # not the one at which the page answers without --phone
        taken.listen()
        port = str(taken.getsockname()[1])
        environment = {**os.environ, "HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path)}
        done = subprocess.run(
            [sys.executable, "-I", "-m", "ur", "web", "--phone", "--no-browser", "--port", port],
            capture_output=True,
            text=True,
            check=False,
            env=environment,
            timeout=60,
        )
    assert done.returncode == 2
    assert f"error: port {port}: address already in use" in done.stderr
    assert "help: choose another one with --port" in done.stderr
