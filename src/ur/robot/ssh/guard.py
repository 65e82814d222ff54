"""Folders and programs that end with this process, even if it is killed by SIGKILL.

A small shell script beside it reads from a pipe into which no program writes: when the pipe closes, the process has
ended.
"""

import os
import select
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import user_error_about

SOCKET_BYTES = 60  # of a folder's path, so that a socket in it still has a valid address, unix(7)
_FOLDER = """\
d=$(mktemp -d "$1/ur-XXXXXXXX") || exit
echo "$d"; exec >&-
read -r _; rm -rf "$d"
"""
# The program reads from the same pipe, so that it detects the end as well; its output goes to a file, because the
# reader may end first.
_PROGRAM = """\
exec 3<&0; log=$1; shift
"$@" <&3 2>"$log" &
exec >&-
read -r _ <&3
kill "$!" 2>/dev/null; wait
"""


@contextmanager
def private_folder() -> Iterator[Path]:
    """Yield a new folder that only this user may enter. It is removed when the context or this process ends."""
    base = os.environ.get("TMPDIR", "/tmp")  # noqa: S108 - made by mktemp
    base = base if len(os.fsencode(base)) <= SOCKET_BYTES and os.path.isdir(base) else "/tmp"  # noqa: S108, PTH112
    guard = _spawn(["sh", "-c", _FOLDER, "sh", base])
    assert guard.stdout
    try:
        name = guard.stdout.readline().strip()
        if not name:
            raise user_error_about(
                base,
                "cannot create a folder there",
                rule="no-folder",
                help=f"free space: df {base} shows how much is left",
            )
        yield Path(name)
    finally:
        _end(guard)


@dataclass(slots=True)
class PipeLines:
    """The lines of a pipe, by its file descriptor, read with a timeout."""

    pipe: int
    _rest: bytes = b""

    def read(self, seconds: float) -> str | None:
        """Return the next line, without its end. None after `seconds`, or when no more lines follow."""
        end = time.monotonic() + seconds
        while b"\n" not in self._rest:
            left = end - time.monotonic()
            more = os.read(self.pipe, 4096) if left > 0 and select.select([self.pipe], [], [], left)[0] else b""
            if not more:
                return None
            self._rest += more
        line, _, self._rest = self._rest.partition(b"\n")
        return line.decode(errors="replace")


@dataclass(frozen=True, slots=True)
class Guarded:
    """A running program. Its standard error goes to `log`."""

    log: Path
    lines: PipeLines

    def wait_for_line(self, line: str, seconds: float) -> bool:
        """Wait until the program prints this line. False if it ends first or `seconds` pass."""
        end = time.monotonic() + seconds
        while (reported := self.lines.read(end - time.monotonic())) is not None:
            if reported == line:
                return True
        return False


@contextmanager
def run_guarded(command: Sequence[str], log: Path, environment: dict[str, str] | None = None) -> Iterator[Guarded]:
    """Run a program in the background. It is ended when the context or this process ends."""
    process = _spawn(["sh", "-c", _PROGRAM, "sh", str(log), *command], environment)
    assert process.stdout
    try:
        yield Guarded(log, PipeLines(process.stdout.fileno()))
    finally:
        _end(process)


def _spawn(command: Sequence[str], environment: dict[str, str] | None = None) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=environment,
        start_new_session=True,  # Ctrl-C is for this process only
    )


def _end(process: subprocess.Popen[str]) -> None:
    assert process.stdin
    assert process.stdout
    process.stdin.close()
    process.stdout.close()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, 9)
        process.wait()
