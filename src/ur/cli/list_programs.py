"""`ur list`: the programs there are, and which of them the selected robot cannot run."""

from __future__ import annotations

import os
import sys

import click

from ur.cli.environment import PACKAGE, current_selection
from ur.cli.programs import Program, find_launch_file, list_programs
from ur.robot.base import Base
from ur.source.diagnostic import UserError

_DIM, _PLAIN = "\x1b[2m", "\x1b[0m"


@click.command("list")
def command() -> int:
    """List the programs that `ur run` knows.

    A line in brackets says what the base of the selected robot lacks for a program.
    """
    programs = list_programs(PACKAGE / "bin")
    width = max((len(program.name) for program in programs), default=0)
    base = _selected_base()
    dim = (_DIM, _PLAIN) if sys.stdout.isatty() else ("", "")
    for program in programs:
        line = f"{program.name:<{width}}  {program.summary}".rstrip()
        lack = _lack(program, base) if base else ""
        sys.stdout.write(line + (f"  {dim[0]}[{lack}]{dim[1]}" if lack else "") + "\n")
    sys.stdout.flush()
    return 0


def _selected_base() -> Base | None:
    """The base of the selected robot; None where nobody knows it."""
    from ur.cli.robot_facts import know_base
    from ur.robot.base import load_base
    from ur.robot.base_search import find_base_package

    try:
        selection = know_base(current_selection(os.environ), os.environ)
        package = find_base_package(PACKAGE, selection.base, os.environ)
        return load_base(package, selection.base, selection.variant) if selection.base else None
    except UserError as problem:
        sys.stderr.write(f"what the base lacks is not known: {problem}\n")
        return None


def _lack(program: Program, base: Base) -> str:
    from ur.cli.needs import describe_lack, list_lacks, read_needs
    from ur.launchfile.world.system import SystemWorld

    path = find_launch_file(program, PACKAGE)
    lacks = list_lacks(base, read_needs(str(path), SystemWorld(os.environ))) if path else ()
    return describe_lack(base, lacks) if lacks else ""
