"""Changes that a robot reverts unless they are confirmed: for `ur robot rename`, `wifi` and `network`."""

from __future__ import annotations

import getpass
import os
import socket
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.commit_confirm.perform import Ways
    from ur.robot.setup.facts import Facts
    from ur.robot.ssh.openssh import Address, SshShell
    from ur.robot.ssh.secret import Secret

WAIT = click.option(
    "--wait",
    type=click.IntRange(5, 600),
    default=60,
    show_default=True,
    metavar="SECONDS",
    help="How long the robot waits for this computer before it reverts the change.",
)
DRY_RUN = click.option("--dry-run", is_flag=True, help="Show what would be changed on the robot, and change nothing.")
PASSWORD_FROM = click.option(
    "--password-from",
    type=int,
    metavar="FD",
    help="Read the robot's password, for sudo there, from this file descriptor.",
)


def read_lines(descriptor: int | None, option: str, count: int) -> list[str]:
    """The first lines of a file descriptor, '' where there are fewer. Raises UserError."""
    if descriptor is None:
        return [""] * count
    try:
        with os.fdopen(descriptor, encoding="utf-8") as stream:
            return [*stream.read().split("\n"), *[""] * count][:count]
    except (OSError, UnicodeDecodeError) as problem:
        raise UserError(error(f"{option} {descriptor}: cannot be read: {problem}", rule="bad-descriptor")) from None


def become_root(shell: SshShell, given: str) -> list[Secret]:
    """Become root on the robot; return the passwords that sudo may be given from now on.

    Raises UserError: that is not possible, or another change is pending there.
    """
    from ur.robot.commit_confirm.perform import refuse_pending
    from ur.robot.ssh.secret import Secret

    candidates = [Secret(given)] if given else []
    if shell.find_sudo(candidates):
        refuse_pending(shell)
        return candidates
    if not given and sys.stdin.isatty():
        candidates = [Secret(getpass.getpass(f"password of {shell.place}: "))]
        if shell.find_sudo(candidates):
            refuse_pending(shell)
            return candidates
    said = "sudo refuses this password" if candidates else "sudo wants a password"
    raise UserError(
        error(
            f"{shell.place}: {said}, expected that of {shell.address.user}, who may use sudo",
            rule="no-root",
            help="run this in a terminal, or give --password-from FD (with wifi: --passwords-from FD)",
        )
    )


def show_plan(change: GuardedChange, facts: Facts) -> None:
    """Print the changes that would be made, for --dry-run."""
    from ur.cli.computer.setup import show_changes
    from ur.robot.commit_confirm.guarded import list_changes

    click.echo(f"{change.title}:")
    show_changes(list_changes(change, facts))
    for text in change.words:
        click.echo(f"then: {text}")


def begin(shell: SshShell, change: GuardedChange, facts: Facts, wait: int) -> str:
    """Hand the change to the robot; the identity of the attempt. Raises UserError when it did not begin."""
    from ur.robot.commit_confirm.guarded import Order
    from ur.robot.commit_confirm.perform import hand_over, is_doubtful, new_identity

    order = Order(new_identity(), f"{getpass.getuser()}@{socket.gethostname()}", wait, change)
    try:
        hand_over(shell, order, facts)
        say(f"{change.title}: the robot begins, and goes back by itself unless it is confirmed within {wait} s")
    except KeyboardInterrupt:
        say(f"{change.title}: stopped; if the robot was told already, it goes back by itself within {wait} s")
        raise
    except UserError as problem:
        if not is_doubtful(problem):
            raise
        say(f"{change.title}: the connection broke while the robot was told; looking for it")
    return order.identity


def finish(
    identity: str, change: GuardedChange, ways: Ways, wait: int, sudo: Sequence[Secret], known_as: str
) -> Address:
    """Come back to the robot and confirm; the way that led there. Raises UserError: taken back, or not seen again."""
    from ur.robot.commit_confirm.perform import come_back, open_as
    from ur.source.progress_line import show_progress

    try:
        with show_progress(f"waiting for {known_as.removesuffix('.local')} to come back"):
            return come_back(identity, change.title, ways, wait, sudo, open_as(known_as), report=say)
    except KeyboardInterrupt:
        say(f"{change.title}: not confirmed; the robot takes it back by itself within {wait} s")
        raise


def say(text: str) -> None:
    """A line that is seen at once, also in a file."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
