"""`ur launch`: start a launch file, in place of roslaunch."""

from __future__ import annotations

import os
import sys

import click

from ur.cli.environment import apply_selection, current_selection
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError, error


@click.command("launch")
@click.option("--screen", is_flag=True, help="Show the output of every node.")
@click.option("--log", is_flag=True, help="Keep the standard output of every node in log files.")
@click.option("--required", is_flag=True, help="End the run with the first node that ends.")
@click.option("--wait", is_flag=True, help="Wait for a master instead of starting one.")
@click.option("-p", "--port", type=click.IntRange(1, 65535), help="Port of the master, where one is started.")
@click.option("--sigint-timeout", type=click.FloatRange(min=0, min_open=True), help="Seconds from SIGINT to SIGTERM.")
@click.option("--sigterm-timeout", type=click.FloatRange(min=0, min_open=True), help="Seconds from SIGTERM to SIGKILL.")
@click.argument("words", nargs=-1, required=True, metavar="[PACKAGE] FILE [ARG:=VALUE]...")
def command(
    screen: bool,
    log: bool,
    required: bool,
    wait: bool,
    port: int | None,
    sigint_timeout: float | None,
    sigterm_timeout: float | None,
    words: tuple[str, ...],
) -> int:
    """Start a launch file, in place of roslaunch.

    The file is given by path, or as a package and a file name. Starts a master where none runs, and stops everything
    again at the end: on Ctrl-C, when a required node ends, or when all nodes have ended.
    """
    from ur.run.processes import start_host  # now, not before: help and completion need none of it

    if screen and log:
        raise UserError(error("--screen and --log exclude each other, expected one", rule="bad-options"))
    selection = know_base(current_selection(os.environ))
    apply_selection(selection)
    host = start_host()  # its start overlaps with the reading of the launch file
    try:
        from ur.cli.plan_files import load_words
        from ur.run.console import Console
        from ur.run.launch import Options, run_plan
        from ur.run.model import Limits

        plan, world = load_words(words, selection)
        if plan is None:
            return 1
        given = dict(word.split(":=", 1) for word in words if ":=" in word)
        base = given.get("robot_base", selection.base)
        variant = given.get("robot_variant", selection.variant if base == selection.base else "")
        defaults = Limits()
        options = Options(
            limits=Limits(
                interrupt=sigint_timeout or defaults.interrupt, terminate=sigterm_timeout or defaults.terminate
            ),
            force_screen=screen,
            force_log=log,
            force_required=required,
            wait_for_master=wait,
            port=port,
            base=base,
            variant=variant,
        )
        try:
            return run_plan(plan, world, host, Console(), options)
        except UserError as problem:
            from ur.source.render import render_human

            sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
            return 1
    finally:
        host.close()


def know_base(selection: Selection) -> Selection:
    """The selection, with the base of this very computer where it is the robot that is selected without one."""
    if selection.base or selection.simulated:
        return selection
    from ur.cli.plan_files import is_this_computer
    from ur.robot.robot_file import load_robot_file

    found = load_robot_file() if is_this_computer(selection.robot) else None
    return Selection(selection.robot, found.base, found.variant) if found else selection
