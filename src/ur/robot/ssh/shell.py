"""A shell on some computer, as its users see it, and the one of this computer."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error


@dataclass(frozen=True, slots=True)
class Done:
    """How a command ended."""

    code: int
    out: str
    err: str


class Shell(Protocol):
    """Runs POSIX shell scripts on one computer, as one user, or as root by that user's right to use sudo."""

    @property
    def place(self) -> str:
        """What the computer is called in messages."""

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> Done:
        """Run a script to its end. Raises UserError when it cannot be run at all, or not within `timeout` seconds."""


class LocalShell:
    """Scripts on this computer. With `terminal`, sudo may ask there for this user's password."""

    place = "this computer"

    def __init__(self, *, terminal: bool = False) -> None:
        self._terminal = terminal

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> Done:
        """Run a script with sh. With `root`, by sudo, which asks on the terminal when there is one."""
        what = f"a command on {self.place}"
        if not root or os.geteuid() == 0:
            return run_process(["sh", "-c", script], stdin=stdin, timeout=timeout, what=what)
        if self._terminal:
            subprocess.run(["sudo", "-v"], check=False)
        # In our own session: sudo's leave to go on without asking again belongs to the terminal.
        command = ["sudo", "-n", "--", "sh", "-c", script]
        done = run_process(command, stdin=stdin, timeout=timeout, what=what, own_session=False)
        if done.code and done.err.startswith("sudo:"):
            reason = done.err.splitlines()[0].removeprefix("sudo: ")
            raise UserError(error(f"{self.place}: sudo refused: {reason}", rule="no-root", help=_NO_ROOT))
        return done


def run_process(
    command: Sequence[str],
    *,
    stdin: str | Secret = "",
    timeout: float,
    what: str,
    environment: dict[str, str] | None = None,
    own_session: bool = True,
) -> Done:
    """Run a program to its end. When it is late or we are stopped it is killed; with `own_session`, all it started too.

    Raises UserError: not found, or not done after `timeout` seconds.
    """
    text = stdin.reveal() if isinstance(stdin, Secret) else stdin
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="surrogateescape",
            env=environment,
            start_new_session=own_session,
        )
    except FileNotFoundError:
        raise UserError(
            error(
                f"{command[0]} is not installed here, needed for {what}", rule="missing-program", help="run: ur setup"
            )
        ) from None
    try:
        out, err = process.communicate(text, timeout=timeout)
    except subprocess.TimeoutExpired:
        raise UserError(error(f"{what}: no answer within {timeout:g} s", rule="no-answer", help=_LATE)) from None
    finally:
        if process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL) if own_session else process.kill()
            process.wait()
    return Done(process.returncode, out, err)


_NO_ROOT = "run this in a terminal, as a user who may use sudo"
_LATE = "check the network (ur doctor), then run this again: it goes on where it stopped"


def quote(*words: str) -> str:
    """Words as part of a shell script."""
    return shlex.join(words)
