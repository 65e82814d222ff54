"""Runs on this computer: one private folder each, with a description and the control socket."""

from __future__ import annotations

import os
import socket
import stat
from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace

from ur.run.record.computer import Computer
from ur.run.record.entry import RunEntry, is_own, runs_folders
from ur.source.diagnostic import UserError, error, error_about
from ur.source.run_users import read_birth
from ur.source.suggest import did_you_mean

SOCKET = "control"
DESCRIPTION = "run.json"
MOST_CHARACTERS = 100_000
_LATEST = 1e12  # s since the epoch; calculations with later times fail


def register_run(entry: RunEntry, environment: Mapping[str, str], uid: int) -> tuple[RunEntry, socket.socket] | None:
    """Create the folder of a run and listen on its socket; None if no folder can be written.

    Without it no client can connect.
    """
    import json

    for root in runs_folders(environment, uid):
        folder = f"{root}/{entry.run}"
        try:
            _make_private(root)
            if not _is_private(root, uid):
                continue
            os.mkdir(folder, 0o700)  # noqa: PTH102 - likewise
            listener = _listen(folder)
            made = replace(entry, folder=folder)
            text = json.dumps(asdict(made), ensure_ascii=False)
            with open(f"{folder}/{DESCRIPTION}.new", "w", encoding="utf-8") as file:  # noqa: PTH123 - likewise
                file.write(text)
            os.rename(f"{folder}/{DESCRIPTION}.new", f"{folder}/{DESCRIPTION}")  # noqa: PTH104 - likewise
        except OSError:
            _remove_folder(folder)
            continue
        return made, listener
    return None


def unregister_run(entry: RunEntry) -> None:
    """Remove the folder of a run."""
    if entry.folder:
        _remove_folder(entry.folder)


def list_runs(environment: Mapping[str, str], uid: int, computer: Computer) -> list[RunEntry]:
    """Return the active runs on this computer, oldest first. Killed runs become ended ones."""
    found = []
    for root in runs_folders(environment, uid):
        try:
            names = sorted(os.listdir(root)) if _is_private(root, uid) else []  # noqa: PTH208 - likewise
        except OSError:
            continue
        for name in names:
            entry = _read_entry(f"{root}/{name}")
            if entry is None:
                _remove_unfinished(f"{root}/{name}")
                continue
            if not is_own(entry, computer):
                continue  # of another computer with the same home folder
            if is_alive(entry, computer):
                found.append(entry)
            else:
                from ur.run.record.ended import write_killed  # rarely: it was killed

                write_killed(entry, environment, uid)
                unregister_run(entry)
    return sorted(found, key=lambda entry: entry.started)


def is_alive(entry: RunEntry, computer: Computer) -> bool:
    """Return whether the supervisor of a run of this computer is still running."""
    return entry.boot in ("", computer.boot) and read_birth(entry.pid) == entry.born


def find_run(runs: Iterable[RunEntry], word: str | None) -> RunEntry:
    """Find the run with this id, prefix of an id, or launch file; without `word`, the only run.

    Raises UserError if there is no run, or none or several match.
    """
    runs = list(runs)
    if not runs:
        raise UserError(error("no run is active", rule="no-run", help="start one: ur launch --detach FILE"))
    matching = [run for run in runs if word is None or run.run == word or run.title == word]
    if not matching and word is not None:
        matching = [run for run in runs if run.run.startswith(word)]
    if len(matching) == 1:
        return matching[0]
    names = ", ".join(run.run for run in (matching or runs))
    if matching:
        what = "several runs" if word is None else f"{word!r} is the name of several runs"
        raise UserError(
            error_about(what, f"{names}, expected one of them", rule="several-runs", help="ur ps lists them")
        )
    near = did_you_mean(str(word), [run.run for run in runs] + [run.title for run in runs])
    raise UserError(
        error(
            f"run {word!r} is not there, expected one of {names}",
            rule="unknown-run",
            help=f"did you mean {near!r}?" if near else "ur ps lists them",
            subject=str(word),
        )
    )


def make_run_name(files: Iterable[str], pid: int) -> tuple[str, str]:
    """Return a run's title and id: the name of its first launch file, and that with the process id."""
    first = next(iter(files), "run").rpartition("/")[2]
    title = first.removesuffix(".xml").removesuffix(".launch") or "run"
    safe = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in title)[:60]
    return title, f"{safe}.{pid}"


def _listen(folder: str) -> socket.socket:
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    place = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        listener.bind(f"/proc/self/fd/{place}/{SOCKET}")  # a socket's address holds 107 bytes only, unix(7)
    finally:
        os.close(place)
    listener.listen(8)
    listener.setblocking(False)
    return listener


def _make_private(root: str) -> None:
    above = os.path.dirname(root)  # noqa: PTH120 - likewise
    if not os.path.lexists(above):
        os.makedirs(os.path.dirname(above), exist_ok=True)  # noqa: PTH103, PTH120 - likewise
        os.mkdir(above, 0o700)  # noqa: PTH102 - likewise
    if not os.path.lexists(root):
        os.mkdir(root, 0o700)  # noqa: PTH102 - likewise


def _is_private(root: str, uid: int) -> bool:
    # The owner of the parent folder, and every user who may write to it, can replace this folder at any time; in
    # /tmp that may be any user. A group may be the user's own.
    for folder, open_to in ((os.path.dirname(root), 0o002), (root, 0o022)):  # noqa: PTH120 - likewise
        status = os.lstat(folder)
        if not stat.S_ISDIR(status.st_mode) or status.st_uid != uid or status.st_mode & open_to:
            return False
    return True


def _remove_unfinished(folder: str) -> None:
    pid = folder.rpartition(".")[2]
    if pid.isdigit() and read_birth(int(pid)) is None:
        _remove_folder(folder)


def _read_entry(folder: str) -> RunEntry | None:
    from ur.source.foreign.json_values import convert_json, read_json

    try:
        # A FIFO in its place would block; other special files have no description.
        descriptor = os.open(f"{folder}/{DESCRIPTION}", os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with open(descriptor, "rb") as file:  # noqa: PTH123 - likewise
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                return None
            found = read_json(file.read(MOST_CHARACTERS), dict)
        entry = convert_json(found, RunEntry)
    except (OSError, ValueError):
        return None
    known = set(found).issubset(RunEntry.__slots__)
    return replace(entry, folder=folder) if known and 0 <= entry.started < _LATEST else None


def _remove_folder(folder: str) -> None:
    import shutil  # with every compression, which a run does not keep in memory

    shutil.rmtree(folder, ignore_errors=True)
