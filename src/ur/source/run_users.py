"""Users of a run: other runs that have joined it, and pages, as files in its control folder.

A run's program with the terminal finds the folder in `FOLDER_VARIABLE`, and reads them.
"""

import os
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from ur.source.replace import replace_file

FOLDER_VARIABLE = "UR_RUN_FOLDER"
"""The environment variable with the control folder of the run, where a program of the run takes the terminal."""

PAGE = "a page"
"""The name of the pages of a server, as a user of a run."""

_USERS = "users"
_MOST_CHARACTERS = 200
_MOST_USERS = 100


def note_user(folder: str, name: str) -> None:
    """Record that this process uses a run, under a display name. Raises OSError if the run has ended."""
    users = Path(folder, _USERS)
    users.mkdir(mode=0o700, exist_ok=True)
    replace_file(_file(folder, name), f"{os.getpid()} {read_birth(os.getpid())} {name}", lasting=False)


def forget_user(folder: str, name: str) -> None:
    """Remove the record of `note_user`."""
    with suppress(OSError):
        _file(folder, name).unlink(missing_ok=True)


def list_users(folder: str) -> list[str]:
    """Return the names of the running processes that use a run, each once."""
    try:
        found = {name for name in map(_read_user, Path(folder, _USERS).iterdir()) if name}
    except OSError:
        return []
    return sorted(found, key=lambda name: (name == PAGE, name))[:_MOST_USERS]


def describe_users(names: Iterable[str]) -> str:
    """Return the clause that these use the robot; empty if there are none."""
    known = list(names)
    if len(known) < 2:
        return f"{known[0]} uses this robot" if known else ""
    return f"{', '.join(known[:-1])} and {known[-1]} use this robot"


def read_birth(pid: int) -> int | None:
    """Read a process's start in clock ticks since boot (field 22 of /proc/PID/stat, proc(5)); None if it has ended."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as file:  # noqa: PTH123 - as a path it takes longer, and it is read often
            words = file.read().rpartition(b")")[2].split()
    except OSError:
        return None
    return None if words[0] in (b"Z", b"X") else int(words[19])


def _read_user(file: Path) -> str:
    """Return the name of a user that is still running; '' for any other file."""
    try:
        with file.open(encoding="utf-8") as opened:
            pid, born, name = opened.read(_MOST_CHARACTERS).split(" ", 2)
        return name if read_birth(int(pid)) == int(born) else ""
    except (OSError, ValueError):
        return ""


def _file(folder: str, name: str) -> Path:
    return Path(folder, _USERS, f"{re.sub(r'[^A-Za-z0-9._-]', '_', name)[:80]}.{os.getpid()}")
