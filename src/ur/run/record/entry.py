"""The description of a run in its folder, for other processes, and the location of those folders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ur.run.record.computer import Computer
from ur.source.user_folders import user_folder

SHARED = "/tmp"  # noqa: S108 - what is in it is used only if it is private


@dataclass(frozen=True, slots=True)
class RunEntry:
    """A run: `born` is the start of its process in clock ticks since boot `boot`, to detect a reused process id.

    `run` is its id, `title` the launch file, `started` in s since the epoch, `folder` its control folder. It belongs to
    the computer `machine` (see `ur.run.record.computer`); `host` is the name of this computer when the run started.
    Entries of earlier versions have neither `machine` nor `boot`.
    """

    run: str
    pid: int
    born: int
    title: str
    master_uri: str
    log_folder: str
    started: float
    detached: bool
    host: str
    folder: str = ""
    machine: str = ""
    boot: str = ""


def runs_folders(environment: Mapping[str, str], uid: int) -> list[str]:
    """Return registry folders of a user's runs, best first.

    The session's runtime folder is not first: logout deletes it.
    """
    found = [f"{user_folder('XDG_STATE_HOME', environment)}/ur/runs"]
    runtime = environment.get("XDG_RUNTIME_DIR", "")
    found.append(f"{runtime}/ur/runs" if runtime.startswith("/") else f"{SHARED}/ur-{uid}/runs")
    return found


def is_own(entry: RunEntry, computer: Computer) -> bool:
    """Return whether a run belongs to this computer, even if the computer had another name when the run started."""
    return entry.machine == computer.machine if entry.machine else entry.host == computer.host
