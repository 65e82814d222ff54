"""`ur x`: run a program on a robot with its windows on this computer."""

from __future__ import annotations

import os

import click

from ur.cli.robots.shell import run_ssh
from ur.request.remote.connection import robot_address
from ur.robot.ssh.failures import explain_failure
from ur.robot.ssh.openssh import STRICT
from ur.robot.ssh.shell import quote, run_process
from ur.source.diagnostic import UserError, error, error_about
from ur.source.progress_line import show_progress

WINDOW = "xlogo"  # of x11-apps, which `ur robot setup` installs
OPEN_SECONDS = 3
STILL_OPEN = 124  # timeout(1)


@click.command("x", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.option("--check", is_flag=True, help="Only open a window, close it, and print whether that works.")
@click.argument("robot")
@click.argument("argv", nargs=-1, type=click.UNPROCESSED, metavar="[PROGRAM ...]")
def command(robot: str, argv: tuple[str, ...], check: bool) -> int:
    """Run a program on a robot with its windows here.

    For example: ur x bob xterm. The exit code is that of the program. A single argument is a command line for the shell
    there, several arguments are passed unchanged.
    """
    if not argv and not check:
        raise click.UsageError("missing argument 'PROGRAM'")
    if not os.environ.get("DISPLAY"):
        raise UserError(
            error(
                "there is no display here, expected DISPLAY to be set",
                rule="no-display",
                help="run this in a terminal of your desktop",
            )
        )
    address = robot_address(robot)
    # Trusted forwarding: OpenGL, and with it RViz, needs extensions that untrusted clients do not get.
    options = ["-Y", "-o", "ExitOnForwardFailure=yes"]
    if not check:
        return run_ssh(address, options, argv)
    script = quote("timeout", str(OPEN_SECONDS), WINDOW)
    command = ["ssh", *options, *STRICT, "-o", "BatchMode=yes", "--", str(address), script]
    with show_progress(f"waiting for a window of {address.host}"):
        done = run_process(command, timeout=30, what=f"a window of {address}")
    if done.code == STILL_OPEN:
        click.echo(f"a window of {address.host} opened here and was closed again")
        return 0
    if done.code == 255:
        raise explain_failure(address, done.err)
    reported = (done.err.strip().splitlines() or ["no reason was given"])[-1]
    if "not found" in reported or "No such file" in reported:
        help_ = f"ur robot setup {address.host}"
    else:
        help_ = f"is the display here open to you? 'xauth list' and 'echo $DISPLAY'; then ur doctor {address.host}"
    raise UserError(error_about(address, f"no window opened: {reported}", rule="no-window", help=help_))
