"""Runs of this computer that are the robot's share of a program, or have its nodes."""

import os
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ur.run.clients.client import RunUnreachable, connect_run, iterate_events
from ur.run.clients.protocol import NodeChanged, RunStopping, Synchronised
from ur.run.join.lock import try_lock
from ur.run.master.client import parse_master_uri
from ur.run.record.registry import RunEntry, runs_folders
from ur.run.remote.protocol import ShareRequest
from ur.source.diagnostic import UserError
from ur.source.run_users import read_birth

_MARK = "--part"
_ANSWER_SECONDS = 5.0


class RequestBusyError(Exception):
    """Another request is in progress."""


@dataclass(frozen=True, slots=True)
class HoldingRun:
    """A run and those of the wanted nodes that it has started and keeps running."""

    entry: RunEntry
    nodes: tuple[str, ...]


def share_arguments(request: ShareRequest) -> list[str]:
    """Return the end of a command line that identifies the share's run."""
    return [_MARK, request.machine, *request.options, "--", *request.words]


def is_marked(command: Sequence[str], request: ShareRequest, earlier: str = "") -> bool:
    """Return whether a command line is that of the run of a request. `earlier` is a former name of the robot."""
    mark = share_arguments(request)
    end = list(command[-len(mark) :])
    if end == mark:
        return True
    if len(end) != len(mark) or end[:2] != [_MARK, earlier]:
        return False
    return _without_name(end, earlier) == _without_name(mark, request.machine)


def _without_name(words: Sequence[str], machine: str) -> list[str]:
    value = f":={machine}"
    return [words[0], *(word[: -len(machine)] if word.endswith(value) else word for word in words[2:])]


def find_share(runs: Iterable[RunEntry], request: ShareRequest) -> RunEntry | None:
    """Find the run that was started for an equal request."""
    for entry in runs:
        with suppress(OSError):
            words = Path(f"/proc/{entry.pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
            if is_marked(words[:-1], request, entry.host.partition(".")[0]):
                return entry
    return None


def find_holders(runs: Iterable[RunEntry], nodes: Collection[str], port: int) -> list[HoldingRun]:
    """Find runs that have some of these nodes, at a master with this port."""
    found = []
    for entry in runs:
        if _port_of(entry) == port:
            running = list_nodes(entry)
            held = tuple(name for name in nodes if name in running)
            if held:
                found.append(HoldingRun(entry, held))
    return found


def list_nodes(entry: RunEntry) -> frozenset[str]:
    """Return the nodes of a run that are running, or restart automatically; empty if it does not answer."""
    names: set[str] = set()
    with suppress(RunUnreachable), connect_run(entry.folder) as client:
        for event in iterate_events(client, _ANSWER_SECONDS):
            if isinstance(event, Synchronised):
                break
            if isinstance(event, NodeChanged) and not event.core and event.state != "ended":
                names.add(event.name)
    return frozenset(names)


def is_stopping(entry: RunEntry) -> bool:
    """Return whether a run is stopping or has just ended."""
    with suppress(RunUnreachable), connect_run(entry.folder) as client:
        for event in iterate_events(client, _ANSWER_SECONDS):
            if isinstance(event, RunStopping):
                break
            if isinstance(event, Synchronised):
                return False
    return True


def wait_exit(entry: RunEntry, until: float) -> bool:
    """Wait until a run's process has ended, at the latest until `until` (s, monotonic); return whether it has."""
    while read_birth(entry.pid) == entry.born:
        if time.monotonic() > until:
            return False
        time.sleep(0.05)
    return True


@contextmanager
def lock_shares(environment: Mapping[str, str], uid: int, patience: float) -> Iterator[None]:
    """Hold the lock for starting or ending shares. Raises RequestBusyError after `patience` s."""
    folder = Path(runs_folders(environment, uid)[0]).parent
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        lock = os.open(folder / "shares.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError:  # a full disk
        yield
        return
    until = time.monotonic() + patience
    try:
        while not try_lock(lock):
            if time.monotonic() > until:
                raise RequestBusyError
            time.sleep(0.05)
        yield
    finally:
        os.close(lock)


def _port_of(entry: RunEntry) -> int | None:
    try:
        return parse_master_uri(entry.master_uri).port
    except UserError:
        return None
