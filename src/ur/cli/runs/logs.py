"""`ur logs`: the output of a node."""

import os
import sys
import time
from pathlib import Path

import click

from ur.cli.runs.detached import (
    choose_run,
    connect,
    describe_age,
    describe_end,
    find_node_name,
    list_own_ended,
    list_own_runs,
)
from ur.run.clients.client import RunClient, iterate_events
from ur.run.clients.protocol import NodeChanged, Synchronised
from ur.run.record.registry import EndedRun, RunEntry, find_ended, find_run
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.printable import printable

POLL_PERIOD = 0.1  # s


@click.command("logs")
@click.argument("node", required=False)
@click.option("--run", metavar="RUN", help="The run it belongs to; may be left out where there is only one.")
@click.option("-f", "--follow", is_flag=True, help="Continue with new output, until Ctrl-C or the end of the run.")
@click.option("-n", "--lines", type=click.IntRange(0), help="Only so many lines from the end.")
@click.option("--path", "only_path", is_flag=True, help="Print the path of the log file only.")
def command(node: str | None, run: str | None, follow: bool, lines: int | None, only_path: bool) -> int:
    """Print what a node has printed so far.

    Without NODE, prints what the run itself has reported, if it is detached. For a run that has ended (`ur ps
    --ended`), or if nothing runs any more, prints how it ended and its last lines.
    """
    ended = find_ended_run(run)
    if ended is not None:
        return show_ended(ended, node, lines, only_path=only_path)
    entry = choose_run(run)
    with connect(entry) as client:
        path = f"{entry.log_folder}/{entry.run}.log"
        logs = {event.name: event.log for event in _read_state(client)} if node or not Path(path).exists() else {}
        if node is None and logs:
            message = f"{entry.run} writes to its terminal, expected a node: one of {', '.join(logs)}"
            raise user_error(message, rule="no-log", help=f"ur logs {next(iter(logs))}")
        if node is not None:
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
    """Report that a node, or a run itself, has printed nothing, and for how long it has been running."""
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
        raise user_error_about(
            path, f"{reason}, expected a log file", rule="no-log", help="a node that never started has none"
        ) from None


def find_ended_run(name: str | None) -> EndedRun | None:
    """Find the ended run with this name, if no running one matches; without a name: if no run is active."""
    runs = list_own_runs()
    if name is None and runs:
        return None
    if name is not None and runs:
        try:
            find_run(runs, name)
        except UserError as problem:
            if problem.diagnostics[0].rule != "unknown-run":
                return None
        else:
            return None
    return find_ended(list_own_ended(), name)


def show_ended(run: EndedRun, node: str | None, lines: int | None, *, only_path: bool) -> int:
    """Print the log of a node of an ended run, or the run's end and its last lines. Raises UserError."""
    if node is None:
        path = f"{run.entry.log_folder}/{run.entry.run}.log"
    else:
        path = run.logs[find_node_name(node, list(run.logs))]
    if only_path:
        click.echo(path)
        return 0
    sys.stderr.write(f"{describe_end(run, time.time())}\n")
    sys.stderr.flush()
    try:
        found = Path(path).read_bytes().splitlines(keepends=True)
    except OSError as problem:
        if node is not None:
            reason = (problem.strerror or str(problem)).lower()
            raise user_error_about(path, f"{reason}, expected a log file", rule="no-log") from None
        found = [f"{printable(line)}\n".encode() for line in run.lines]
    sys.stdout.buffer.write(b"".join(found if lines is None else found[-lines:] if lines else []))
    sys.stdout.buffer.flush()
    return 0


_REMEMBERED = 1024  # bytes before the position, by which it is found again


class LogFollower:
    """The bytes of an open log file, from its beginning on."""

    def __init__(self, file: int) -> None:
        self._file = file
        self._position = 0
        self._last = b""

    def read(self) -> bytes:
        """Return the bytes since the last call.

        If the beginning of the file was removed, these are the bytes after those returned last; the whole file if those
        were removed, too. Raises OSError.
        """
        size = os.fstat(self._file).st_size
        if size == self._position:
            return b""
        if size < self._position or not self._is_known(self._position):
            self._position = self._find(size)
        parts = []
        while part := os.pread(self._file, 1 << 20, self._position):
            parts.append(part)
            self._position += len(part)
        data = b"".join(parts)
        self._last = (self._last + data[-_REMEMBERED:])[-_REMEMBERED:]
        return data

    def _is_known(self, position: int) -> bool:
        return os.pread(self._file, len(self._last), position - len(self._last)) == self._last

    def _find(self, size: int) -> int:
        """Return the latest position in a file of this size after the bytes read last; 0 if there is none."""
        wanted = self._last
        end = size
        while wanted and end > 0:
            start = max(0, end - (1 << 20))
            found = os.pread(self._file, end - start, start).rfind(wanted)
            if found >= 0:
                return start + found + len(wanted)
            end = start + len(wanted) - 1 if start else 0
        return 0
