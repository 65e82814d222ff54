"""Description of a run: what its folder holds for every other process, and where those folders are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ur.run.record.computer import Computer
from ur.source.user_folders import user_folder

SHARED = "/tmp"  # noqa: S108 - what is in it is used only if it is private


@dataclass(frozen=True, slots=True)
class RunEntry:
    """A run: `born` is when its process started, in clock ticks since the boot `boot`: a reused process id is not it.

    `run` is its id, `title` the launch file, `started` s since the epoch, `folder` its control folder. It belongs to
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
    """Registry folders of a user's runs, best first. The session's runtime folder is not first: logout deletes it."""
    found = [f"{user_folder('XDG_STATE_HOME', environment)}/ur/runs"]
    runtime = environment.get("XDG_RUNTIME_DIR", "")
    found.append(f"{runtime}/ur/runs" if runtime.startswith("/") else f"{SHARED}/ur-{uid}/runs")
    return found


def is_own(entry: RunEntry, computer: Computer) -> bool:
    """Return whether a run belongs to this computer, which may have had another name when the run started."""
    return entry.machine == computer.machine if entry.machine else entry.host == computer.host
