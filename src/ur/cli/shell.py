"""`ur shell`: a shell, or one command, on a robot."""

from __future__ import annotations

import os

import click

from ur.cli.environment import current_selection
from ur.robot.record import find_user, records_folder
from ur.robot.ssh.openssh import Address, parse_address
from ur.source.diagnostic import UserError, error


@click.command("shell", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.argument("robot", required=False)
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="[COMMAND ...]")
def command(robot: str | None, words: tuple[str, ...]) -> int:
    """Open a shell on a robot, or run one command there.

    ROBOT is a name, HOST or USER@HOST; without it, the selected robot. Its host key must be known: `ur robot setup` has
    seen to that. The exit code is that of the command.
    """
    address = robot_address(robot)
    options = ["-o", "StrictHostKeyChecking=yes", "-o", "ConnectTimeout=10"]
    os.execvp("ssh", ["ssh", *options, *([] if words else ["-t"]), str(address), *words])  # noqa: S606 - no shell


def robot_address(robot: str | None) -> Address:
    """Whom a ROBOT on the command line means. Raises UserError: none is given and none is selected."""
    if robot is None:
        selected = current_selection(os.environ)
        if selected.simulated:
            raise UserError(
                error(
                    "no robot is given, and the selected one is simulated, expected a robot with a computer of its own",
                    rule="no-robot",
                    help="ur use ROBOT, or name it; 'ur robots' shows who is there",
                )
            )
        robot = selected.robot
    name = robot.rpartition("@")[2].removesuffix(".local")
    return parse_address(robot, find_user(name, records_folder(os.environ)))
