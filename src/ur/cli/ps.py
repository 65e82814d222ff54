"""`ur ps`: the runs on this computer."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict

import click

from ur.cli.detached import list_own_runs


@click.command("ps")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(as_json: bool) -> int:
    """List the runs on this computer.

    Those that are detached and those in a terminal. RUN is what `ur attach`, `ur stop`, `ur wait` take; its beginning
    is enough where it is the only one.
    """
    runs = list_own_runs()
    if as_json:
        click.echo(json.dumps([asdict(run) for run in runs], indent=2))
        return 0
    if not runs:
        sys.stderr.write("nothing runs\n")
        return 0
    rows = [("RUN", "PROCESS", "SINCE", "", "MASTER")]
    rows += [
        (
            run.run,
            str(run.pid),
            describe_age(time.time() - run.started),
            "detached" if run.detached else "in a terminal",
            run.master_uri,
        )
        for run in runs
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        click.echo("  ".join(word.ljust(width) for word, width in zip(row, widths, strict=True)).rstrip())
    return 0


def describe_age(seconds: float) -> str:
    """A time in its two largest units: `3 min 20 s`."""
    left = int(max(0.0, seconds))
    units = (("d", 86400), ("h", 3600), ("min", 60), ("s", 1))
    parts = []
    for unit, length in units:
        count, left = divmod(left, length)
        if count or unit == "s":
            parts.append(f"{count} {unit}")
    return " ".join(parts[:2])
