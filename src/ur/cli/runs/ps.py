"""`ur ps`: the runs on this computer."""

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict

import click

from ur.cli.runs.detached import describe_age, describe_reason, list_own_ended, list_own_runs
from ur.run.join.decision import read_claims
from ur.run.record.registry import EndedRun, RunEntry
from ur.run.remote.own_clients import read_clients


@click.command("ps")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--ended", is_flag=True, help="List the runs that have ended, with the reason, instead.")
def command(as_json: bool, ended: bool) -> int:
    """List the runs on this computer.

    Lists detached runs and those of terminals. USED BY names the runs that have joined a run, and on a robot the
    computers whose programs use it.
    """
    if ended:
        return _list_ended(as_json=as_json)
    runs = list_own_runs()
    if as_json:
        click.echo(json.dumps([describe_run(run) for run in runs], indent=2))
        return 0
    if not runs:
        sys.stderr.write("no run is active\n")
        return 0
    users = {run.run: [*list_clients(run), *list_joined(run, runs)] for run in runs}
    rows = [("RUN", "PROCESS", "SINCE", "", "MASTER", "USED BY" if any(users.values()) else "")]
    rows += [
        (
            run.run,
            str(run.pid),
            describe_age(time.time() - run.started),
            describe_place(run),
            run.master_uri,
            ", ".join(users[run.run]),
        )
        for run in runs
    ]
    _print_table(rows)
    return 0


def _list_ended(*, as_json: bool) -> int:
    found = list_own_ended()
    if as_json:
        click.echo(json.dumps([describe_ended(run) for run in found], indent=2))
        return 0
    if not found:
        sys.stderr.write("no run has ended yet\n")
        return 0
    now = time.time()
    rows = [("RUN", "ENDED", "AFTER", "", "HOW")]
    rows += [
        (
            run.entry.run,
            f"{describe_age(now - run.ended)} ago",
            describe_age(run.ended - run.entry.started),
            describe_place(run.entry),
            describe_reason(run),
        )
        for run in found
    ]
    _print_table(rows)
    return 0


def _print_table(rows: Sequence[Sequence[str]]) -> None:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


def describe_place(run: RunEntry) -> str:
    """Describe whether a run is detached."""
    return "detached" if run.detached else "in a terminal"


def describe_ended(run: EndedRun) -> dict[str, object]:
    """Describe an ended run as a JSON object, without the machine-id(5), which is confidential."""
    entry = {name: value for name, value in asdict(run.entry).items() if name not in ("machine", "boot", "folder")}
    return {**entry, "ended": run.ended, "exit_code": run.exit_code, "cause": run.cause, "lines": run.lines}


def list_joined(run: RunEntry, runs: Sequence[RunEntry]) -> list[str]:
    """Return the ids of the runs, among these, that have joined a run."""
    return [each.run for each in runs if run.run in read_claims(each.folder).joined]


def describe_run(run: RunEntry) -> dict[str, object]:
    """Describe a run as a JSON object, without the machine-id(5), which is confidential."""
    fields = {name: value for name, value in asdict(run).items() if name not in ("machine", "boot")}
    return {**fields, "clients": list_clients(run), "joined": list(read_claims(run.folder).joined)}


def list_clients(run: RunEntry) -> list[str]:
    """Return the names of the other computers that use a run."""
    return list(dict.fromkeys(client.name for client in read_clients(run.folder)))
