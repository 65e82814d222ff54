"""The processes that write the memory of a black box to a file: after an event, and if the black box is killed.

    python -I -m ur_nodes.black_box.guard MEMORY PIPE FOLDER KEPT

MEMORY and PIPE are descriptors: the block of a ring, and a pipe that the black box holds open. Once it is closed, the
lines in it are the reasons of a file; a guard finds none if the black box was killed, and _CLEAN if it ends.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ur.run.host.descendants import RECORDING_GUARD, name_process

if TYPE_CHECKING:
    import subprocess

_CLEAN = b"\0"
_KILLED = "the process of the black box was killed"
_LONGEST_WRITE = 60.0  # s


class GuardedMemory:
    """Memory that this process shares with its guard, and with a short process for each file."""

    def __init__(self, size: int, folder: Path, kept: int) -> None:
        self._memory = os.memfd_create("ur_black_box")
        self._folder, self._kept = folder, kept
        os.ftruncate(self._memory, size)
        self.block = mmap.mmap(self._memory, size)
        reading, self._pipe = os.pipe()
        try:
            self.guard = self._start(reading)
        finally:
            os.close(reading)

    def _start(self, pipe: int, output: int | None = None) -> subprocess.Popen[str]:
        import subprocess  # not in the guard itself, which waits in little memory

        return subprocess.Popen(
            [sys.executable, "-I", "-m", __name__, *map(str, (self._memory, pipe, self._folder, self._kept))],
            pass_fds=(self._memory, pipe),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            text=True,
            start_new_session=True,  # Ctrl-C is for the black box, which ends the guard
        )

    def write(self, reasons: Sequence[str]) -> str:
        """Write a file in a process of its own, whose memory ends with it. Returns its path. Raises RecordingError."""
        from subprocess import PIPE, TimeoutExpired

        from ur_nodes.black_box.recording_file import RecordingError

        reading, pipe = os.pipe()
        try:
            writer = self._start(reading, PIPE)
        finally:
            os.close(reading)
            with suppress(BrokenPipeError):  # it was killed
                os.write(pipe, "".join(f"{each}\n" for each in reasons).encode())
            os.close(pipe)
        try:
            path, problem = writer.communicate(timeout=_LONGEST_WRITE)
        except TimeoutExpired:
            writer.kill()
            path, problem = "", f"{self._folder}: not written within {_LONGEST_WRITE:g} s"
        if not path:
            raise RecordingError(problem.strip().removeprefix("error: ") or f"its process ended: {writer.wait()}")
        return path.strip()

    def end(self) -> None:
        """End the guard without a file."""
        with suppress(BrokenPipeError):  # it was killed
            os.write(self._pipe, _CLEAN)
        os.close(self._pipe)
        self.guard.wait(10.0)


def main(arguments: list[str]) -> int:
    """Wait for the end of the pipe, and write."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    name_process(RECORDING_GUARD)  # the host of a run whose supervisor was killed does not kill it while it writes
    memory, pipe, folder, kept = int(arguments[0]), int(arguments[1]), Path(arguments[2]), int(arguments[3])
    received = b""
    while data := os.read(pipe, 4096):
        received += data
    if received == _CLEAN:
        return 0
    from ur_nodes.black_box.history import copy_ring, read_history
    from ur_nodes.black_box.recording_file import RecordingError, write_recording

    reasons = received.decode().splitlines() or [_KILLED]
    with mmap.mmap(memory, os.fstat(memory).st_size) as block:
        history = tuple(read_history(copy_ring(block)))
    if not history and not received:
        return 0  # it ended before it had anything
    try:
        path = write_recording(folder, history, reasons, time.time_ns() - time.monotonic_ns(), kept)
    except (RecordingError, ImportError) as problem:
        sys.stderr.write(f"error: {problem}\n" if received else f"error: {_KILLED}, and not written: {problem}\n")
        return 1
    sys.stdout.write(f"{path}\n" if received else f"black box: {path}: {_KILLED}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
