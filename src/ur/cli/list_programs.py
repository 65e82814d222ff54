"""`ur list`: the programs there are."""

from __future__ import annotations

import sys

import click

from ur.cli.environment import PACKAGE
from ur.cli.programs import list_programs


@click.command("list")
def command() -> int:
    """List the programs that `ur run` knows."""
    programs = list_programs(PACKAGE / "bin")
    width = max((len(program.name) for program in programs), default=0)
    for program in programs:
        sys.stdout.write(f"{program.name:<{width}}  {program.summary}".rstrip() + "\n")
    sys.stdout.flush()
    return 0
