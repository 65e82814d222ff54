"""Records of runs that have ended: how they ended, their last lines, the log files of their nodes."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

from ur.cli.runs.detached import describe_end, find_node_name, list_own_ended, list_own_runs
from ur.run.record.ended import EndedRun, find_ended
from ur.run.record.registry import find_run
from ur.source.diagnostic import UserError, error_about
from ur.source.printable import printable


def find_ended_run(name: str | None) -> EndedRun | None:
    """The run of a name that has ended, where none that runs fits; without a name: where nothing runs."""
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
    """Print the log of a node of a run that has ended, or how the run ended and its last lines. Raises UserError."""
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
            raise UserError(error_about(path, f"{reason}, expected a log file", rule="no-log")) from None
        found = [f"{printable(line)}\n".encode() for line in run.lines]
    sys.stdout.buffer.write(b"".join(found if lines is None else found[-lines:] if lines else []))
    sys.stdout.buffer.flush()
    return 0
