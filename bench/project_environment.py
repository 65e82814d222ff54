"""Whichever Python starts a bench, it goes on in the project's environment, set up for tests."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_PYTHON = _ROOT / ".venv" / "bin" / "python"


def enter_environment() -> None:
    """Set the computer up where it is not yet, then start the same script again with the project's Python.

    Returns where that has happened, with the repository on the path of modules.
    """
    if not (_ROOT / ".venv" / "ready-test").is_file():
        done = subprocess.run(["bash", str(_ROOT / "tools" / "set_up.bash"), "test"], check=False)
        if done.returncode:
            sys.exit(done.returncode)
    if Path(sys.executable) != _PYTHON:
        os.execv(_PYTHON, [str(_PYTHON), *sys.argv])
    sys.path.insert(0, str(_ROOT))
