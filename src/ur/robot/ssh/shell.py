"""Shells: the protocol of a shell on any computer, and the shell of this computer."""

import os
import selectors
import shlex
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import user_error, user_error_about

MOST_BYTES = 1 << 26  # of a command's output: a list of all packages has some hundred kilobytes
_CHUNK = 1 << 16


@dataclass(frozen=True, slots=True)
class ShellResult:
    """The result of a command."""

    code: int
    out: str
    err: str


# Shell functions. `last PATH...` syncs files, or folder entries, to the disk. `replace NEW FILE` renames NEW to FILE:
# after a power cut the file has its old or its new content, completely.
REPLACE = (
    'last() { sync -- "$@" 2>/dev/null || sync; }; replace() { last "$1" && mv -f -- "$1" "$2" && last "${2%/*}"; }; '
)


class Shell(Protocol):
    """Runs POSIX shell scripts on one computer as one user, or as root by sudo."""

    @property
    def destination(self) -> str:
        """The name of the computer in messages."""

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        """Run a script to its end. Raises UserError if it cannot be run, or takes longer than `timeout` seconds."""


class LocalShell:
    """Runs scripts on this computer. With `terminal`, sudo may ask there for this user's password."""

    destination = "this computer"

    def __init__(self, *, terminal: bool = False, most: int = MOST_BYTES) -> None:
        """A command that prints more than `most` bytes is ended."""
        self._terminal, self._most = terminal, most

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        """Run a script with sh. With `root`, by sudo, which asks on the terminal if there is one."""
        what = f"a command on {self.destination}"
        if not root or os.geteuid() == 0:
            return run_process(["sh", "-c", script], stdin=stdin, timeout=timeout, what=what, most=self._most)
        if self._terminal:
            subprocess.run(["sudo", "-v"], check=False)
        # In the session of this process: sudo caches its authentication per terminal.
        command = ["sudo", "-n", "--", "sh", "-c", script]
        done = run_process(command, stdin=stdin, timeout=timeout, what=what, own_session=False)
        if done.code and done.err.startswith("sudo:"):
            reason = done.err.splitlines()[0].removeprefix("sudo: ")
            raise user_error_about(self.destination, f"sudo refused: {reason}", rule="no-root", help=_NO_ROOT)
        return done


def run_process(
    command: Sequence[str],
    *,
    stdin: str | Secret = "",
    timeout: float,
    what: str,
    own_session: bool = True,
    most: int = MOST_BYTES,
) -> ShellResult:
    """Run a program to its end.

    After the timeout or an interruption it is killed; with `own_session`, its children too.

    Raises UserError if it is not found, takes longer than `timeout` seconds, or prints more than `most` bytes.
    """
    text = stdin.reveal() if isinstance(stdin, Secret) else stdin
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=own_session,
        )
    except ValueError as problem:  # a null byte in an argument
        raise user_error_about(
            what, f"{problem}", rule="bad-argument", help="is a name or an answer in it what you expect?"
        ) from None
    except (FileNotFoundError, PermissionError):  # the second where a folder of PATH cannot be read
        raise user_error(
            f"{command[0]} is not installed here, needed for {what}",
            rule="missing-program",
            help="run: ur setup",
            subject=command[0],
        ) from None
    try:
        out, err = _exchange(process, text.encode(errors="surrogateescape"), time.monotonic() + timeout, most)
    except TimeoutError:
        raise user_error_about(what, f"no answer within {timeout:g} s", rule="no-answer", help=_LATE) from None
    except OverflowError:
        raise user_error_about(
            what,
            f"the answer has more than {most >> 20} MB, and no end",
            rule="endless-answer",
            help="is it the computer that you expect? Look at it: ur shell",
        ) from None
    finally:
        if process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL) if own_session else process.kill()
            process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            with suppress(OSError):
                if stream:
                    stream.close()
    return ShellResult(process.returncode, out, err)


def _exchange(process: subprocess.Popen[bytes], text: bytes, end: float, most: int) -> tuple[str, str]:
    """Write the text to a process and read its output to the end.

    Raises TimeoutError, and OverflowError above `most`.
    """
    assert process.stdin
    assert process.stdout
    assert process.stderr
    reported: dict[int, list[bytes]] = {process.stdout.fileno(): [], process.stderr.fileno(): []}
    size, rest = 0, memoryview(text)
    os.set_blocking(process.stdin.fileno(), False)
    with selectors.DefaultSelector() as waiting:
        for number in reported:
            waiting.register(number, selectors.EVENT_READ)
        waiting.register(process.stdin, selectors.EVENT_WRITE)
        while waiting.get_map():
            if (left := end - time.monotonic()) <= 0:
                raise TimeoutError
            for key, _ in waiting.select(left):
                if key.fileobj is process.stdin:
                    with suppress(BlockingIOError):
                        try:
                            rest = rest[os.write(key.fd, rest[:_CHUNK]) if rest else 0 :]
                        except BrokenPipeError:  # the process does not read it
                            rest = rest[len(rest) :]
                    if not rest:
                        waiting.unregister(process.stdin)
                        process.stdin.close()
                    continue
                more = os.read(key.fd, _CHUNK)
                reported[key.fd].append(more)
                size += len(more)
                if size > most:
                    raise OverflowError
                if not more:
                    waiting.unregister(key.fd)
    try:
        process.wait(max(0.0, end - time.monotonic()))
    except subprocess.TimeoutExpired:
        raise TimeoutError from None
    out, err = (b"".join(parts).decode(errors="surrogateescape") for parts in reported.values())
    return out.replace("\r\n", "\n").replace("\r", "\n"), err.replace("\r\n", "\n").replace("\r", "\n")


_NO_ROOT = "run this in a terminal, as a user who may use sudo"
_LATE = "check the network (ur doctor), then run this again: it continues where it stopped"


def quote(*words: str) -> str:
    """Quote arguments for a shell script."""
    return shlex.join(words)
