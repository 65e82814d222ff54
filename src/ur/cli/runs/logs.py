"""`ur logs`: what a node has printed."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

from ur.cli.runs.detached import choose_run, connect, describe_age, find_node_name
from ur.cli.runs.ended_logs import find_ended_run, show_ended
from ur.run.clients.client import RunClient, iterate_events
from ur.run.clients.protocol import NodeChanged, Synchronised
from ur.run.output.log_follower import LogFollower
from ur.run.record.entry import RunEntry
from ur.source.diagnostic import UserError, error_about

POLL_PERIOD = 0.1  # s


@click.command("logs")
@click.argument("node", required=False)
@click.option("--run", metavar="RUN", help="The run it belongs to; may be left out where there is only one.")
@click.option("-f", "--follow", is_flag=True, help="Continue with new output, until Ctrl-C or the end of the run.")
@click.option("-n", "--lines", type=click.IntRange(0), help="Only so many lines from the end.")
@click.option("--path", "only_path", is_flag=True, help="Print the path of the log file only.")
def command(node: str | None, run: str | None, follow: bool, lines: int | None, only_path: bool) -> int:
    """Print what a node has printed so far.

    Without NODE: what the run itself reports, if it is detached. Of a run that has ended (`ur ps --ended`), or
    where nothing runs any more: how it ended, and its last lines.
    """
    ended = find_ended_run(run)
    if ended is not None:
        return show_ended(ended, node, lines, only_path=only_path)
    entry = choose_run(run)
    with connect(entry) as client:
        if node is None:
            path = f"{entry.log_folder}/{entry.run}.log"
        else:
            logs = {event.name: event.log for event in _read_state(client)}
            node = find_node_name(node, list(logs))
            path = logs[node]
        if only_path:
            click.echo(path)
            return 0
        try:
            return _show(Path(path), client, lines, _describe_silence(node, entry, path), follow=follow)
        except KeyboardInterrupt:
            return 0


def _read_state(client: RunClient) -> list[NodeChanged]:
    found = []
    for event in iterate_events(client):
        if isinstance(event, NodeChanged):
            found.append(event)
        elif isinstance(event, Synchronised):
            break
    return found


def _describe_silence(node: str | None, entry: RunEntry, path: str) -> str:
    """Say that a node, or a run itself, has printed nothing, and for how long it could have."""
    try:
        began = Path(path).stat().st_ctime if node is not None else entry.started
    except OSError:
        began = entry.started
    ago = describe_age(time.time() - began)
    what = f"node {node}" if node is not None else f"run {entry.run}"
    return f"{what} has printed nothing since it was started {ago} ago"


def _show(path: Path, client: RunClient, lines: int | None, silent: str, *, follow: bool) -> int:
    """Print a log file from its beginning or its last lines; `silent` is printed for an empty one."""
    try:
        with path.open("rb") as file:
            follower = LogFollower(file.fileno())
            data = follower.read()
            if not data:
                sys.stderr.write(f"{silent}\n")
                sys.stderr.flush()
            if lines is not None:
                data = b"".join(data.splitlines(keepends=True)[-lines:]) if lines else b""
            while True:
                sys.stdout.buffer.write(data)
                sys.stdout.buffer.flush()
                if not follow or (not data and client.receive() is None):
                    return 0
                data = follower.read()
                if not data:
                    time.sleep(POLL_PERIOD)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(
            error_about(
                path, f"{reason}, expected a log file", rule="no-log", help="a node that never started has none"
            )
        ) from None
