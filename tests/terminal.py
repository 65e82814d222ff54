"""A shell on a real terminal: a tmux of its own."""

import os
import re
import subprocess
import time
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


class TmuxTerminal:
    """`command` in `folder`, with `ur` on its PATH and the folder as home. `close` ends everything in it.

    `more` are variables that it gets in addition.
    """

    def __init__(self, command: Sequence[str], folder: Path, more: Mapping[str, str] | None = None) -> None:
        self.name = f"ur-test-{uuid.uuid4().hex[:8]}"
        (folder / "ur").write_text(f'#!/bin/sh\nexec "{ROOT}/.venv/bin/python" -I -m ur "$@"\n')
        (folder / "ur").chmod(0o755)
        environment = {
            "PATH": f"{folder}:{os.environ['PATH']}",
            "HOME": str(folder),
            "TERM": "screen",
            "LC_ALL": "C.UTF-8",
            "ROS_PACKAGE_PATH": str(folder),
            **(more or {}),
        }
        self._run("new-session", "-d", "-x", "120", "-y", "40", *command, env=environment, cwd=folder)

    def type(self, *keys: str) -> None:
        """Press keys, as tmux names them; other words are typed as they are."""
        self._run("send-keys", *keys)

    def until(self, text: str, seconds: float = 60.0) -> str:
        """Wait until a text is on the screen; the whole screen then."""
        end = time.monotonic() + seconds
        while text not in (screen := self.screen()):
            assert time.monotonic() < end, f"waited for {text!r}, saw:\n{screen}"
            time.sleep(0.05)
        return screen

    def screen(self) -> str:
        """Its text, with one blank for several: shells differ in those."""
        return re.sub(" +", " ", self._run("capture-pane", "-p", "-J"))

    def close(self) -> None:
        """End the shell and what runs in it."""
        self._run("kill-server")

    def _run(self, *words: str, env: dict[str, str] | None = None, cwd: Path | None = None) -> str:
        command = ["tmux", "-f", "/dev/null", "-L", self.name, *words]
        return subprocess.run(command, check=True, capture_output=True, text=True, env=env, cwd=cwd, timeout=60).stdout
