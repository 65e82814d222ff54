"""`ur run`: run a program on the selected robot."""

import os
import sys
from collections.abc import Callable, Sequence
from errno import ENOEXEC
from pathlib import Path

import click

from ur.cli.launch.command import make_options
from ur.cli.launch.launch import explain_problem, launch_line
from ur.cli.launch.options import LEASE
from ur.request.environment import add_own_package, apply_selection, current_selection
from ur.request.launch_request import LaunchOptions, check_options
from ur.request.programs import PACKAGE, check_arguments, find_launch_file, find_program, read_launch_argv
from ur.robot.selection import Selection
from ur.source.arguments import split_argv
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.project import launch_library


@click.command("run", context_settings={"ignore_unknown_options": True, "help_option_names": []})
@click.argument("program")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
def command(program: str, arguments: tuple[str, ...], watch: bool, ask: bool, take_over: bool, unattended: bool) -> int:
    """Run a program on the selected robot.

    `ur list` lists the programs, and `ur run PROGRAM --help` describes the arguments of one. Everything after the
    program's name is passed to the program: usually arguments of its launch file, written NAME:=VALUE. The options are
    passed on as well: they decide how to start while another client drives the robot. A file NAME.py is a script of
    yours, as `ur new script` writes one.
    """
    if is_script(program):
        return run_script(program, arguments)
    lease = {"--watch": watch, "--ask": ask, "--take-over": take_over, "--unattended": unattended}
    options = [name for name, given in lease.items() if given]
    found = find_program(PACKAGE, program, add_own_package(os.environ))
    if any(text in ("--help", "-h") for text in arguments) and find_launch_file(found) is not None:
        from ur.cli.launch.program_help import describe_program

        sys.stdout.write(describe_program(found, os.environ))
        return 0
    if any(text.partition("=")[0] == "--ros" for text in arguments):
        message = "ur run: unknown option '--ros', expected a program for the selected ROS"
        raise user_error(message, rule="bad-options", help="select ROS 2 before: ur use sim --ros 2")
    selection = current_selection(os.environ)
    if not selection.simulated:
        from ur.cli.robots.shell import is_over_ssh, run_there

        if is_over_ssh(selection):
            return run_there(selection, found, options, arguments)
    apply_selection(selection)
    launched = read_launch_argv(found) if found.folder == PACKAGE else None
    if launched is not None and not any(text.startswith("-") for text in arguments):
        chosen = LaunchOptions(watch=watch, ask=ask, take_over=take_over, unattended=unattended, program=found.name)
        return _launch([*launched, *arguments], chosen)
    check_arguments(found, split_argv(arguments).arguments, os.environ)
    sys.stdout.flush()
    try:
        os.execv(found.path, [str(found.path), *options, *arguments])  # noqa: S606 - a program, not a shell command
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        help_ = "its first line must name an interpreter, as '#!/bin/bash' does" if problem.errno == ENOEXEC else None
        raise user_error_about(found.path, f"cannot be run: {reason}", rule="bad-program", help=help_) from None


def _launch(argv: list[str], options: LaunchOptions) -> int:
    """Launch in this process, as the program would with two more processes, of bash and Python."""
    line = split_argv(argv)
    check_options(line.names, options)
    try:
        return launch_line(line, options)
    except UserError as problem:
        if problem.diagnostics[0].rule == "unknown-argument":
            raise
        return explain_problem(problem)


command.params.extend(make_options(LEASE))


def is_script(program: str) -> bool:
    """Return whether a program's name is that of a Python file."""
    return program.endswith(".py") and Path(program).is_file()


def run_script(
    path: str,
    arguments: Sequence[str],
    *,
    apply: Callable[[Selection], None] = apply_selection,
    execute: Callable[[str, list[str]], object] = os.execv,
) -> int:
    """Run a script in place of this process, for the selected robot. Raises UserError."""
    selection = current_selection(os.environ)
    if not selection.simulated:
        from ur.cli.robots.shell import is_over_ssh

        if is_over_ssh(selection):
            there = f"copy {path} to the robot and type there: ur run {Path(path).name}"
            message = f"{selection.robot} runs ROS 2 and is reached by ssh, expected a script on the robot itself"
            raise user_error(message, rule="not-here", help=there)
    apply(selection)
    if os.environ.get("ROS_VERSION") == "0":
        message = "nodes run without ROS, expected ROS 1 or ROS 2 between a script and the robot"
        raise user_error(message, rule="no-ros", help="install it: ur setup; 'ur use --ros 2' needs no Debian package")
    sys.stdout.flush()
    node = str(launch_library() / "lib" / "node")
    execute(node, [node, str(Path(path).absolute()), *arguments])
    return 0
