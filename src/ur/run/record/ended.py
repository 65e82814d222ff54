"""Ended runs with time, exit code and cause, stored for the last MAX_RUNS of a user."""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from ur.run.record.computer import Computer
from ur.run.record.entry import RunEntry, is_own, runs_folders
from ur.source.foreign.json_values import read_json, write_json
from ur.source.replace import replace_file

MAX_RUNS = 50
MAX_LINES = 30
_MAX_BYTES = 1 << 18
_MAX_LINE = 500


@dataclass(frozen=True, slots=True)
class EndedRun:
    """A run that has ended.

    `ended` is in s since the epoch, `exit_code` None for one that was killed. `cause` is a text for the user, ''
    without one. `lines` are the last lines that the run itself printed; `logs` are the log files of its nodes by name.
    """

    entry: RunEntry
    ended: float
    exit_code: int | None
    cause: str = ""
    lines: tuple[str, ...] = ()
    logs: Mapping[str, str] = field(default_factory=dict)


def write_ended(run: EndedRun, environment: Mapping[str, str], uid: int) -> None:
    """Store an ended run, and remove the oldest beyond MAX_RUNS. No effect if the file cannot be written."""
    folder = _folder(environment, uid)
    lines = tuple(line[:_MAX_LINE] for line in run.lines[-MAX_LINES:])
    text = write_json(replace(run, lines=lines))
    with suppress(OSError):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(folder / f"{run.entry.run}.{int(run.entry.started)}.json", text, lasting=False)
        kept = sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
        for path in kept[:-MAX_RUNS]:
            path.unlink(missing_ok=True)


def write_killed(entry: RunEntry, environment: Mapping[str, str], uid: int) -> None:
    """Store a run whose process was killed, with the content of its log file and the time of detection."""
    lines: tuple[str, ...] = ()
    with suppress(OSError), Path(entry.log_folder, f"{entry.run}.log").open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _MAX_BYTES))
        lines = tuple(file.read(_MAX_BYTES).decode("utf-8", "replace").splitlines()[-MAX_LINES:])
    write_ended(EndedRun(entry, time.time(), None, "its process was killed", lines), environment, uid)


def list_ended(environment: Mapping[str, str], uid: int, computer: Computer) -> list[EndedRun]:
    """Return the ended runs of a user on this computer, latest last."""
    found = [_read(path) for path in _folder(environment, uid).glob("*.json")]
    return sorted((run for run in found if run and is_own(run.entry, computer)), key=lambda run: run.ended)


def find_ended(runs: Collection[EndedRun], word: str | None) -> EndedRun | None:
    """Find the latest run with this id, prefix of an id, or launch file; without `word`, the latest of all."""
    for exact in (True, False):
        for run in reversed(list(runs)):
            names = (run.entry.run, run.entry.title)
            if word is None or (word in names if exact else run.entry.run.startswith(word)):
                return run
    return None


def _folder(environment: Mapping[str, str], uid: int) -> Path:
    return Path(runs_folders(environment, uid)[0]).parent / "ended"


def _read(path: Path) -> EndedRun | None:
    try:
        with path.open("rb") as file:
            return read_json(file.read(_MAX_BYTES * 4), EndedRun)
    except (OSError, ValueError):
        return None
