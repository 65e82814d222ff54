"""`ur run`: a program on the selected robot."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from errno import ENOEXEC

import click

from ur.cli.launch.options import make_lease_options
from ur.request.environment import PACKAGE, apply_selection, current_selection, know_own_package
from ur.request.programs import Program, find_launch_file, find_program
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

_TRUTH_VALUES = ("simulate", "bring_up", "use_rviz")  # in every launch file that declares them


@click.command("run", context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("program")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
def command(program: str, arguments: tuple[str, ...], **lease: bool) -> int:
    """Run a program on the selected robot.

    `ur list` says which programs there are, and `ur run PROGRAM --help` describes the arguments of one. What follows
    the program's name is its own: usually arguments of its launch file, written NAME:=VALUE. The options are handed to
    it: they say how to begin where somebody else drives the robot.
    """
    options = [f"--{name.replace('_', '-')}" for name, given in lease.items() if given]
    found = find_program(PACKAGE, program, know_own_package(os.environ))
    if any(word in ("--help", "-h") for word in arguments) and find_launch_file(found) is not None:
        from ur.cli.launch.program_help import describe_program

        sys.stdout.write(describe_program(found, os.environ))
        return 0
    apply_selection(current_selection(os.environ))
    if any(":=" in word for word in arguments):
        check_arguments(found, arguments)
    sys.stdout.flush()
    try:
        os.execv(found.path, [str(found.path), *options, *arguments])  # noqa: S606 - a program, not a shell command
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        help_ = "its first line must name an interpreter, as '#!/bin/bash' does" if problem.errno == ENOEXEC else None
        raise UserError(error(f"{found.path}: cannot be run: {reason}", rule="bad-program", help=help_)) from None


def check_arguments(program: Program, words: Sequence[str]) -> None:
    """Raise UserError for an argument that a program's launch file does not declare, or a bad truth value."""
    path = find_launch_file(program)
    if path is None:
        return  # the program reads its arguments itself
    from ur.launchfile.world.system import SystemWorld
    from ur.request.plan_files import declared_arguments

    declared = declared_arguments([str(path)], SystemWorld(os.environ))
    for name in (word.partition(":=")[0] for word in words if ":=" in word):
        if name not in declared and not name.startswith("_"):
            near = did_you_mean(name, declared)
            help_ = f"did you mean {near}:=...?" if near else f"'ur run {program.name} --help' describes its arguments"
            known = ", ".join(declared) or "no arguments"
            message = f"unknown argument {name!r} of program {program.name!r}, expected one of {known}"
            raise UserError(error(message, rule="unknown-argument", help=help_))
    for name, _, value in (word.partition(":=") for word in words):
        if name in _TRUTH_VALUES and value.lower() not in ("true", "false", "1", "0") and not value.startswith("$("):
            near = did_you_mean(value, ("true", "false"))
            help_ = f"did you mean {name}:={near}?" if near else f"for example {name}:=false"
            message = f"argument {name!r} is {value!r}, expected true or false"
            raise UserError(error(message, rule="bad-argument", help=help_))


command.params.extend(make_lease_options())
