"""`ur run`: a program on the selected robot."""

from __future__ import annotations

import os
import sys

import click

from ur.cli.environment import PACKAGE, apply_selection, current_selection
from ur.cli.programs import find_program
from ur.source.diagnostic import UserError, error


@click.command("run", context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("program")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
def command(program: str, arguments: tuple[str, ...]) -> int:
    """Run a program on the selected robot.

    `ur list` says which programs there are. What follows the program's name is its own: usually arguments of its
    launch file, written NAME:=VALUE.
    """
    found = find_program(PACKAGE / "bin", program)
    apply_selection(current_selection(os.environ))
    sys.stdout.flush()
    try:
        os.execv(found.path, [str(found.path), *arguments])  # noqa: S606 - a program, not a shell command
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{found.path}: cannot be run: {reason}", rule="bad-program")) from None
