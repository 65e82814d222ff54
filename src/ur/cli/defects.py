"""Keeping the traceback of a defect for its report, out of the user's sight."""

from __future__ import annotations

import os
import platform
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path


def write_defect(problem: BaseException, words: Sequence[str], environment: Mapping[str, str]) -> Path | None:
    """Write the traceback to a log file of its own and return where; None when nowhere can be written."""
    text = f"ur {' '.join(words)}\nPython {platform.python_version()}, {platform.platform()}\n\n"
    text += "".join(traceback.format_exception(problem))
    state = environment.get("XDG_STATE_HOME", "")
    home = (
        Path(state) if state.startswith("/") else Path(environment.get("HOME") or tempfile.gettempdir(), ".local/state")
    )
    for folder in (home / "ubiquity_launches", Path(tempfile.gettempdir())):
        path = folder / f"ur-defect-{os.getpid()}-{os.urandom(2).hex()}.log"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Exclusive: in a folder for everybody, somebody may have put a link of this name.
            descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:  # noqa: PTH123
                file.write(text)
        except OSError:
            continue
        return path
    return None
