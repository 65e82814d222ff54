"""`ur shell`: a shell, or one command, on a robot."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import click

from ur.cli.environment import current_selection
from ur.robot.record import find_user, records_folder
from ur.robot.ssh.openssh import Address, explain_failure, parse_address
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
        # Ctrl-C is for ssh, which hands it on. A handler of ours is not inherited, as ignoring it would be.
        before = signal.signal(signal.SIGINT, lambda *_: None)
        try:
            code = subprocess.run(
                ["ssh", *STRICT, "-E", str(log), *options, str(address), *script], check=False
            ).returncode
        except FileNotFoundError:
            raise UserError(error("ssh is not installed here", rule="missing-program", help="run: ur setup")) from None
        finally:
            signal.signal(signal.SIGINT, before)
        said = log.read_text(encoding="utf-8", errors="replace")
    if code == 255 and said.strip():
        raise explain_failure(address, said)
    sys.stderr.writelines(line for line in said.splitlines(keepends=True) if not line.startswith("Connection to "))
    return code if code >= 0 else 128 - code


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
