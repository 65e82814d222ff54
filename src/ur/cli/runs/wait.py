"""`ur wait`: wait until every node of a run is ready; and the start of detached runs."""

import select
import sys
import time
from collections.abc import Callable

import click

from ur.cli.runs.detached import choose_run, connect
from ur.run.clients.protocol import Watch
from ur.run.clients.run_state import apply_events, begin_state, list_missing
from ur.run.detach import Detach, run_detached
from ur.run.record.registry import RunEntry
from ur.source.progress_line import show_progress


@click.command("wait")
@click.argument("run", required=False)
@click.option(
    "--timeout-ready",
    "timeout",
    type=click.FloatRange(min=0),
    default=30.0,
    show_default=True,
    help="Seconds that nodes get to be up.",
)
def command(run: str | None, timeout: float) -> int:
    """Return when every node of a run is up.

    A node is up when its process runs, the master knows it, and the conditions of its `ready:` comment are met. The
    exit code is 1, with what is missing and why, if that takes longer than the limit or the run ends.
    """
    return wait_ready(choose_run(run), timeout)


def wait_ready(entry: RunEntry, timeout: float) -> int:
    """Wait at most `timeout` s until every node is ready; print the missing ones, and return the exit code."""
    end = time.monotonic() + timeout
    state = begin_state()
    with connect(entry) as client, show_progress(f"waiting for the nodes of {entry.run}") as progress:
        client.send(Watch(readiness=True))
        while (left := end - time.monotonic()) > 0:
            select.select([client], [], [], left)
            events = client.receive()
            if events is None:
                sys.stderr.write(f"error: run {entry.run} has ended\n")
                return 1
            state = apply_events(state, events)
            if state.cause is not None:
                sys.stderr.write(f"error: run {entry.run} ends: {state.cause}\n")
                return 1
            late, count = list_missing(state), sum(state.count().values())
            if count and not late:
                return 0
            progress(f"waiting for {len(late)} of {count} nodes: {', '.join(late)}")
    missing = list_missing(state)
    sys.stderr.write(f"error: not up after {timeout:g} s{':' if missing else ''}\n")
    for name, reasons in missing.items():
        sys.stderr.write(f"  {name}: {'; '.join(reasons)}\n")
    return 1


def start_detached(run: Callable[[Detach], int], wait: float | None) -> int:
    """Start a detached run, print how to connect to it, and with `wait` (s) wait until every node is ready."""

    def print_name(name: str) -> int:
        sys.stdout.write(f"{name}\n")
        sys.stdout.flush()
        if sys.stderr.isatty():
            sys.stderr.write(f"it runs on: ur attach {name}, ur logs NODE, ur stop {name}\n")
        if wait is None:
            return 0
        return wait_ready(choose_run(name), wait)

    return run_detached(run, print_name)
