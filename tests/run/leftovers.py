"""Finding what a run left behind, however it hides: every process of it has the test's folder in its environment."""

import os
import time
from contextlib import suppress
from pathlib import Path


def find_processes(folder: Path, *, without: frozenset[int] = frozenset()) -> dict[int, str]:
    """The command lines of the processes that belong to a test's folder, by process id."""
    marker = f"ROS_HOME={folder}/".encode()
    found = {}
    for entry in os.listdir("/proc"):  # noqa: PTH208 - names, not paths
        if not entry.isdigit() or int(entry) in without:
            continue
        with suppress(OSError):
            with open(f"/proc/{entry}/environ", "rb") as file:  # noqa: PTH123 - of all processes, many times
                if marker not in file.read():
                    continue
            if Path("/proc", entry, "stat").read_text().rpartition(")")[2].split()[0] not in "ZX":
                found[int(entry)] = Path("/proc", entry, "cmdline").read_bytes().replace(b"\0", b" ").decode()
    return found


def wait_nothing_left(folder: Path, limit: float = 60.0, *, without: frozenset[int] = frozenset()) -> None:
    """Wait until no process of a test's folder runs. The limit is in s."""
    end = time.monotonic() + limit
    while left := find_processes(folder, without=without):
        assert time.monotonic() < end, left
        time.sleep(0.02)
