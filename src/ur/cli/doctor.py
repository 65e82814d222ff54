"""`ur doctor`: what keeps this computer and a robot from working together."""

from __future__ import annotations

import getpass
import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from urllib.parse import urlsplit

import click

from ur.cli.shell import robot_address
from ur.robot.doctor.look import look_at_pair
from ur.robot.doctor.rules import Finding, diagnose
from ur.robot.ssh.openssh import Address, SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, Shell
from ur.source.diagnostic import UserError

MASTER_PORT = 11311


@click.command("doctor")
@click.argument("robot", required=False)
@click.option("--fix", is_flag=True, help="Apply the fixes that can do no harm, then look again.")
@click.option(
    "--password-from", type=int, metavar="FD", help="Read the robot's password here where it refuses our key."
)
def command(robot: str | None, fix: bool, password_from: int | None) -> int:
    """Find what is wrong between this computer and a robot.

    Looks from both ends; each finding says what to do. ROBOT is a name, HOST or USER@HOST; without it, the selected
    robot. The exit code is 0 when all is well, 1 when something is wrong, 2 when the robot could not be reached.
    """
    address = robot_address(robot)
    here = LocalShell(terminal=sys.stdin.isatty())
    password, refused = None, False
    with ExitStack() as stack:
        try:
            there = stack.enter_context(connect(address))
        except UserError as problem:
            password = _password(address, password_from) if problem.diagnostics[0].rule == "refused" else None
            if password is None:
                raise
            there, refused = stack.enter_context(connect(address, password=password)), True
        findings = _look(here, there, refused)
        _print(findings)
        fixable = [finding for finding in findings if finding.fix]
        if not fix or not fixable:
            return 1 if findings else 0
        if any(finding.fix and finding.fix.where == "there" and finding.fix.root for finding in fixable):
            _become_root(there, password)
        for finding in fixable:
            _apply(finding, here, there)
        left = _look(here, there, refused=False)
    click.echo("after the fixes:")
    _print(left)
    return 1 if left else 0


def _look(here: LocalShell, there: SshShell, refused: bool) -> list[Finding]:
    nodes = list_nodes(there.address.host)
    return diagnose(look_at_pair(here, there, getpass.getuser(), nodes, key_refused=refused))


def _password(address: Address, descriptor: int | None) -> Secret | None:
    """A way in where the key is refused: asked for, or read from a descriptor; None when there is neither."""
    if descriptor is not None:
        with os.fdopen(descriptor, encoding="utf-8") as stream:
            text = stream.readline().rstrip("\n")
    elif sys.stdin.isatty():
        text = getpass.getpass(f"{address} refuses our key; its password: ")
    else:
        text = ""
    return Secret(text) if text else None


def _print(findings: Sequence[Finding]) -> None:
    for finding in findings:
        colour = sys.stdout.isatty()
        head = click.style("problem", fg="red", bold=True) if colour else "problem"
        click.echo(f"{head}: {finding.message} [{finding.rule}]\n  help: {finding.help}")
    fixable = sum(finding.fix is not None for finding in findings)
    if not findings:
        click.echo("all is well")
    elif fixable:
        click.echo(f"{fixable} of {len(findings)} can be mended with --fix")


def _become_root(there: SshShell, password: Secret | None) -> None:
    if not there.find_sudo([password] if password else []) and sys.stdin.isatty():
        there.find_sudo([Secret(getpass.getpass(f"password of {there.place}: "))])


def _apply(finding: Finding, here: Shell, there: Shell) -> None:
    assert finding.fix is not None
    shell = here if finding.fix.where == "here" else there
    done = shell.run(finding.fix.script, root=finding.fix.root)
    said = (done.err or done.out).strip().splitlines()
    click.echo(f"  {finding.rule}: {'done' if done.code == 0 else f'failed: {said[-1] if said else done.code}'}")


def list_nodes(host: str) -> list[tuple[str, str]]:
    """The nodes that a robot's ROS master knows, and the host in the address of each; empty when no master answers."""
    from ur.run.xml_rpc import Refused, Unanswered, call_method

    try:
        _, _, state = call_method((host, MASTER_PORT), "getSystemState", ["/ur"], 2.0)
        names = sorted({node for group in state for _, nodes in group for node in nodes})
        addresses = [call_method((host, MASTER_PORT), "lookupNode", ["/ur", name], 2.0)[2] for name in names]
    except (Refused, Unanswered, OSError, ValueError, TypeError):
        return []
    return [(name, urlsplit(str(address)).hostname or "") for name, address in zip(names, addresses, strict=True)]
