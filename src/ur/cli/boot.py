"""`ur boot`: what a robot starts by itself."""

from __future__ import annotations

import getpass
import sys

import click

from ur.cli.setup import show_changes
from ur.cli.shell import robot_address
from ur.robot.boot import PREFIX, Unit, is_unit_name, master_unit, program_unit
from ur.robot.setup.engine import bring_about
from ur.robot.setup.facts import Request
from ur.robot.setup.packages import WantedService
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.openssh import SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import UserError, error

_robot = click.option("--robot", help="Which robot. [default: the selected one]")


@click.group("boot", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Choose what a robot starts when it boots."""
    if context.invoked_subcommand is None:
        from ur.cli.help import show_help

        show_help(["boot"])


@command.command("install", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@_robot
@click.option("--name", help="What to call it. [default: the first word of the command]")
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="[COMMAND ...]")
def install(robot: str | None, name: str | None, words: tuple[str, ...]) -> int:
    """Start a ROS master when the robot boots, and a command after it.

    Both wait for the robot's address and are started again when they end. The command is run by a login shell of the
    robot's user; for instance: ur boot install --robot bob roslaunch PACKAGE FILE.
    """
    address = robot_address(robot)
    units = [master_unit(address.user)]
    if words:
        called = name or words[0].rpartition("/")[2].lower()
        if not is_unit_name(called):
            raise UserError(
                error(
                    f"{called!r} is not a name for a boot service, expected lower case letters, digits, - and _",
                    rule="bad-name",
                    help="give --name",
                )
            )
        units.append(program_unit(called, words, address.user))
    wanted = [item for unit in units for item in _wanted(unit)]
    with connect(address) as shell:
        _become_root(shell)
        _, count = bring_about(
            shell,
            lambda _: wanted,
            address.user,
            Request(address.user),
            root=True,
            report=lambda change: show_changes([change]),
        )
        click.echo("nothing to do" if not count else f"{address.host} starts it now, and whenever it boots")
    return 0


@command.command("status")
@_robot
def status(robot: str | None) -> int:
    """Show what the robot starts when it boots, and how that is."""
    with connect(robot_address(robot)) as shell:
        done = shell.run(f"systemctl list-units --all --plain --no-legend {quote(PREFIX + '*')}")
    click.echo(done.out.rstrip() or "nothing is started at boot")
    return 0


@command.command("remove")
@_robot
@click.argument("names", nargs=-1, metavar="[NAME ...]")
def remove(robot: str | None, names: tuple[str, ...]) -> int:
    """Stop boot services and start them no more; without NAME, all of them."""
    bad = [name for name in names if not is_unit_name(name) and name != "master"]
    if bad:
        raise UserError(error(f"{bad[0]!r} is not the name of a boot service", rule="bad-name", help="ur boot status"))
    patterns = " ".join(f"/etc/systemd/system/{PREFIX}{name}.service" for name in names or ["*"])
    script = (
        f'for f in {patterns}; do [ -e "$f" ] || continue; u=${{f##*/}}; '
        'systemctl disable --now "$u" 2>&1; rm -f "$f"; echo "$u: removed"; done; systemctl daemon-reload'
    )
    with connect(robot_address(robot)) as shell:
        _become_root(shell)
        done = shell.run(script, root=True)
    removed = [line for line in done.out.splitlines() if line.endswith(": removed")]
    click.echo("\n".join(removed) or "nothing to remove")
    return 0 if done.code == 0 else 1


def _wanted(unit: Unit) -> list[Wanted]:
    service = f"{unit.service}.service"
    return [
        WantedFile(
            unit.service, unit.path, unit.text, then=f"systemctl daemon-reload; systemctl try-restart {service}"
        ),
        WantedService(f"{unit.service} runs", service),
    ]


def _become_root(shell: SshShell) -> None:
    if shell.find_sudo([]):
        return
    if sys.stdin.isatty() and shell.find_sudo([Secret(getpass.getpass(f"password of {shell.place}: "))]):
        return
    raise UserError(
        error(f"{shell.place}: sudo refuses, expected its password", rule="no-root", help="run this in a terminal")
    )
