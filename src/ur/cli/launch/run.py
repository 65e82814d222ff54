"""`ur run`: run a program on the selected robot."""

from __future__ import annotations

import os
import sys
from errno import ENOEXEC

import click

from ur.cli.launch.options import make_lease_options
from ur.request.arguments import split_argv
from ur.request.environment import PACKAGE, add_own_package, apply_selection, current_selection
from ur.request.program_arguments import check_arguments
from ur.request.programs import find_launch_file, find_program
from ur.source.diagnostic import UserError, error_about


@click.command("run", context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("program")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
@click.option("--web", is_flag=True, help="Serve the page of 'ur web' while the program runs.")
@click.option("--foxglove", is_flag=True, help="As --web; print an address for Foxglove and Lichtblick, too.")
def command(program: str, arguments: tuple[str, ...], web: bool, foxglove: bool, **lease: bool) -> int:
    """Run a program on the selected robot.

    `ur list` says which programs there are, and `ur run PROGRAM --help` describes the arguments of one. What follows
    the program's name is its own: usually arguments of its launch file, written NAME:=VALUE. The options are handed to
    it: they say how to begin where somebody else drives the robot.
    """
    options = [f"--{name.replace('_', '-')}" for name, given in lease.items() if given]
    found = find_program(PACKAGE, program, add_own_package(os.environ))
    if any(text in ("--help", "-h") for text in arguments) and find_launch_file(found) is not None:
        from ur.cli.launch.program_help import describe_program

        sys.stdout.write(describe_program(found, os.environ))
        return 0
    apply_selection(current_selection(os.environ))
    check_arguments(found, split_argv(arguments)[1], os.environ)
    if web or foxglove:
        from ur.cli.launch.run_web import run_with_page

        return run_with_page(program, [*options, *arguments], foxglove=foxglove)
    sys.stdout.flush()
    try:
        os.execv(found.path, [str(found.path), *options, *arguments])  # noqa: S606 - a program, not a shell command
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        help_ = "its first line must name an interpreter, as '#!/bin/bash' does" if problem.errno == ENOEXEC else None
        raise UserError(error_about(found.path, f"cannot be run: {reason}", rule="bad-program", help=help_)) from None


command.params.extend(make_lease_options())
