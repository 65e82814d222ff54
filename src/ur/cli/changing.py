"""Output about changes to a computer: the differences, and the progress of a long change."""

from __future__ import annotations

import getpass
import shutil
import socket
import sys
import threading
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from ur.robot.commit_confirm.perform import ChangeAddresses, begin_change, come_back, open_as
from ur.robot.commit_confirm.perform import become_root as become
from ur.robot.setup.change import Change
from ur.source.printable import printable, printable_lines

if TYPE_CHECKING:
    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.setup.facts import ComputerFacts
    from ur.robot.ssh.address import Address
    from ur.robot.ssh.openssh import SshShell
    from ur.robot.ssh.secret import Secret

PROGRESS_SECONDS = 15.0  # s between lines of progress on output where they cannot be overwritten

_CLEAR = "\r\033[K"


def show_changes(changes: Sequence[Change]) -> None:
    """Print changes one after the other, in colour on a terminal."""
    for change in changes:
        click.echo(f"{click.style(printable(change.title), bold=True)}:")
        for line in map(printable, change.difference.splitlines()):
            colour = {"+": "green", "-": "red", "@": "cyan"}.get(line[:1])
            click.echo(f"  {click.style(line, fg=colour)}")


class ChangeReporter:
    """Prints lines about one robot, each with its name as a prefix unless that is empty.

    With `live`, progress is one line.
    """

    def __init__(self, name: str, *, live: bool = False) -> None:
        self._prefix, self._live = f"{printable(name)}: " if name else "", live
        self._shown = 0.0  # time of the last printed progress
        self._lock = threading.Lock()  # progress comes from another thread

    def __call__(self, text: str) -> None:
        """Print a line."""
        with self._lock:
            sys.stdout.write(f"{_CLEAR if self._live else ''}{self._prefix}{printable_lines(text)}\n")
            sys.stdout.flush()

    def show_progress(self, title: str, seconds: float, line: str) -> None:
        """Print the progress of a long change with its last line of output, which comes from the other computer."""
        text = f"{self._prefix}{title}, {seconds:.0f} s: {printable(line)}"
        with self._lock:
            if self._live:
                sys.stdout.write(_CLEAR + text[: shutil.get_terminal_size().columns - 1])
            elif time.monotonic() - self._shown >= PROGRESS_SECONDS:
                self._shown = time.monotonic()
                sys.stdout.write(text[:160] + "\n")
            sys.stdout.flush()


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


def become_root(shell: SshShell, given: str) -> list[Secret]:
    """Become root on the robot with the given password, or one that the user enters; return the passwords for sudo.

    Raises UserError if root access fails, or another change is pending there.
    """
    from ur.robot.ssh.secret import Secret

    def ask() -> Secret:
        return Secret(getpass.getpass(f"password of {shell.destination}: "))

    return become(shell, Secret(given) if given else None, ask if sys.stdin.isatty() else None)


def show_plan(change: GuardedChange, facts: ComputerFacts) -> None:
    """Print the changes that would be made, for --dry-run."""
    from ur.robot.commit_confirm.guarded import list_changes

    click.echo(f"{change.title}:")
    show_changes(list_changes(change, facts))
    for text in change.words:
        click.echo(f"then: {text}")


def begin(shell: SshShell, change: GuardedChange, facts: ComputerFacts, wait: int) -> str:
    """Send the change to the robot; return the id of the attempt. Raises UserError if it did not start."""
    requester = f"{getpass.getuser()}@{socket.gethostname()}"
    return begin_change(shell, change, facts, requester, wait, print_line)


def finish(
    identity: str, change: GuardedChange, addresses: ChangeAddresses, wait: int, sudo: Sequence[Secret], known_as: str
) -> Address:
    """Connect to the robot again and confirm; return its address. Raises UserError: reverted, or not reached again."""
    from ur.source.progress_line import show_progress

    try:
        with show_progress(f"waiting for {known_as.removesuffix('.local')} to come back"):
            return come_back(identity, change.title, addresses, wait, sudo, open_as(known_as), report=print_line)
    except KeyboardInterrupt:
        print_line(f"{change.title}: not confirmed; the robot takes it back by itself within {wait} s")
        raise


def print_line(text: str) -> None:
    """Print a line and flush it, so that it is visible at once in a file, too."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
