"""What verbs about runs share: finding one, following it, and starting one that is detached."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable

from ur.run.client import RunClient, RunGone, connect_run
from ur.run.detach import LetGo, run_detached
from ur.run.registry import RunEntry, find_run, list_runs
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean


def list_own_runs() -> list[RunEntry]:
    """The runs of this user on this computer, oldest first."""
    return list_runs(os.environ, os.getuid(), socket.gethostname())


def choose_run(word: str | None) -> RunEntry:
    """The run that a word of the command line means. Raises UserError."""
    return find_run(list_own_runs(), word)


def connect(entry: RunEntry) -> RunClient:
    """Connect to a run. Raises UserError when it has ended meanwhile."""
    try:
        return connect_run(entry.folder)
    except RunGone:
        raise UserError(error(f"run {entry.run} has ended just now", rule="unknown-run", help="ur ps")) from None


def find_node_name(word: str, names: list[str]) -> str:
    """The full name of a node, given with or without leading slash. Raises UserError."""
    full = word if word.startswith("/") or word in names else "/" + word
    if full in names:
        return full
    near = did_you_mean(full, names)
    raise UserError(
        error(
            f"node {word!r} is not in this run, expected one of {', '.join(names) or '(none)'}",
            rule="unknown-node",
            help=f"did you mean {near}?" if near else None,
        )
    )


def start_detached(run: Callable[[LetGo], int], wait: float | None) -> int:
    """Start a run that is detached, say how to reach it, and with `wait` (s) wait until every node is up."""

    def tell(name: str) -> int:
        sys.stdout.write(f"{name}\n")
        sys.stdout.flush()
        if sys.stderr.isatty():
            sys.stderr.write(f"it runs on: ur attach {name}, ur logs NODE, ur stop {name}\n")
        if wait is None:
            return 0
        from ur.cli.wait import wait_ready

        return wait_ready(choose_run(name), wait)

    return run_detached(run, tell)
