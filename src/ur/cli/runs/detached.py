"""Functions that verbs about runs share: find a run, and follow it."""

import os
import time

from ur.run.clients.client import RunClient, RunUnreachable, connect_run
from ur.run.join.decision import read_claims
from ur.run.record.registry import EndedRun, RunEntry, find_ended, find_run, list_ended, list_runs, read_computer
from ur.run.supervisor.events import CTRL_C
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable
from ur.source.suggest import suggest


def list_own_runs() -> list[RunEntry]:
    """Return the runs of this user on this computer, oldest first."""
    return list_runs(os.environ, os.getuid(), read_computer())


def choose_run(name: str | None) -> RunEntry:
    """Return the run with this name or prefix; without a name the only one that has not joined another.

    Raises UserError if there is none, or several; for one that has ended with the reason of its end.
    """
    runs = list_own_runs()
    try:
        return find_run(runs if name is not None else leave_out_joined(runs), name)
    except UserError as problem:
        if problem.diagnostics[0].rule not in ("no-run", "unknown-run"):
            raise
        ended = find_ended(list_own_ended(), name)
        if ended is None:
            raise
        what = "no run is active" if name is None else f"run {name!r} does not run"
        raise user_error(
            f"{what}; {describe_end(ended, time.time())}",
            rule=problem.diagnostics[0].rule,
            help=f"'ur logs --run {ended.entry.run}' prints its last lines, 'ur ps --ended' lists what has ended",
        ) from None


def leave_out_joined(runs: list[RunEntry]) -> list[RunEntry]:
    """Return the runs that have not joined another one of these."""
    names = {entry.run for entry in runs}
    return [entry for entry in runs if not names.intersection(read_claims(entry.folder).joined)]


def list_own_ended() -> list[EndedRun]:
    """Return the ended runs of this user on this computer, latest last."""
    list_own_runs()  # converts killed runs to ended ones
    return list_ended(os.environ, os.getuid(), read_computer())


def describe_end(run: EndedRun, now: float) -> str:
    """Describe a run's end: 'm_wander.7952 ended 3 min 2 s ago with exit code 1: /wander is required and has ended'."""
    ago = describe_age(now - run.ended)
    return f"{run.entry.run} ended {ago} ago, {describe_reason(run)}"


def describe_reason(run: EndedRun) -> str:
    """Describe the end of a run and its cause: 'by Ctrl-C', or 'exit code 1: /wander is required and has ended'."""
    if run.exit_code is None:
        return printable(run.cause)
    if run.cause == CTRL_C:
        return f"by {CTRL_C}"
    return f"exit code {run.exit_code}" + (f": {printable(run.cause)}" if run.cause else "")


def describe_age(seconds: float) -> str:
    """Format a time in its two largest units: `3 min 20 s`."""
    left = int(max(0.0, seconds))
    units = (("d", 86400), ("h", 3600), ("min", 60), ("s", 1))
    parts = []
    for unit, length in units:
        count, left = divmod(left, length)
        if count or unit == "s":
            parts.append(f"{count} {unit}")
    return " ".join(parts[:2])


def connect(entry: RunEntry) -> RunClient:
    """Connect to a run. Raises UserError if it has ended meanwhile."""
    try:
        return connect_run(entry.folder)
    except RunUnreachable:
        raise user_error(
            f"run {entry.run} has ended just now", rule="unknown-run", help="ur ps", subject=entry.run
        ) from None


def find_node_name(name: str, names: list[str]) -> str:
    """Return the full name of a node, given with or without leading slash. Raises UserError."""
    full = name if name.startswith("/") or name in names else "/" + name
    if full in names:
        return full
    raise user_error(
        f"node {name!r} is not in this run, expected one of {', '.join(names) or '(none)'}",
        rule="unknown-node",
        help=suggest(full, names),
        subject=name,
    )
