"""`ur shell`: a shell, or one command, on a robot."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import click

from ur.cli.environment import current_selection
from ur.cli.progress import show_progress
from ur.robot.record import find_user, records_folder
from ur.robot.ssh.openssh import Address, SshShell, connect, explain_failure, parse_address
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import UserError, error

STRICT = ("-o", "StrictHostKeyChecking=yes", "-o", "ConnectTimeout=10")


@click.command("shell", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.argument("robot", required=False)
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="[COMMAND ...]")
def command(robot: str | None, words: tuple[str, ...]) -> int:
    """Open a shell on a robot, or run one command there.

    ROBOT is a name, HOST or USER@HOST; without it, the selected robot. Its host key must be known: `ur robot setup` has
    seen to that. The exit code is that of the command. A COMMAND of one word is a line for the shell there ('ls | wc');
    several words arrive as they are.
    """
    return run_ssh(robot_address(robot), [] if words else ["-t"], words)


def run_ssh(address: Address, options: Sequence[str], words: Sequence[str]) -> int:
    """Run ssh with this terminal and return its exit code. Raises UserError when there was no connection.

    One word is a line for the shell there, several words arrive as they are.
    """
    script = [words[0] if len(words) == 1 else quote(*words)] if words else []
    sys.stdout.flush()
    with tempfile.TemporaryDirectory(prefix="ur-") as folder:
        log = Path(folder) / "log"
        log.touch()
        code = _run_in_front(["ssh", *STRICT, "-E", str(log), *options, "--", str(address), *script])
        said = log.read_text(encoding="utf-8", errors="replace")
    if code == 255 and said.strip():
        raise explain_failure(address, said)
    sys.stderr.writelines(line for line in said.splitlines(keepends=True) if not line.startswith("Connection to "))
    return code if code >= 0 else 128 - code


def _run_in_front(command: Sequence[str]) -> int:
    """Run a program with this terminal; what ends us ends it, and Ctrl-C is its own business. Its exit code."""
    running: list[subprocess.Popen[bytes]] = []
    early: list[int] = []

    def hand_on(number: int, _: object) -> None:
        if number == signal.SIGINT:  # that one comes from the terminal, to both
            return
        if running:
            running[0].send_signal(number)
        else:
            early.append(number)

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    # Before it starts, so that nothing ends us alone. It does not inherit them: handlers end with exec.
    before = [signal.signal(number, hand_on) for number in numbers]
    try:
        running.append(subprocess.Popen(command))
        for number in early:
            running[0].send_signal(number)
        return running[0].wait()
    except FileNotFoundError:
        raise UserError(
            error(f"{command[0]} is not installed here", rule="missing-program", help="run: ur setup")
        ) from None
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)


def connect_robot(
    address: Address, *, password: Secret | None = None, options: Sequence[str] = ()
) -> AbstractContextManager[SshShell]:
    """Log in as `ur.robot.ssh.openssh.connect` does; the terminal shows who is waited for."""
    return connect(address, password=password, options=options, waiting=show_progress)


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
