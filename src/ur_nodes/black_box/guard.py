"""The guard of the black box: writes its memory to a file if its process is killed.

    python -I -m ur_nodes.black_box.guard MEMORY PIPE FOLDER KEPT

MEMORY and PIPE are descriptors: the block of a ring, and a pipe that the black box holds open. A byte in the pipe
means that it ends on purpose; the end of the pipe without one that it was killed.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path

from ur.run.host.descendants import RECORDING_GUARD, name_process

_CLEAN = b"q"


class GuardProcess:
    """A running guard, and the memory that it shares with this process."""

    def __init__(self, size: int, folder: Path, kept: int) -> None:
        import subprocess  # not in the guard itself, which waits in little memory

        memory = os.memfd_create("ur_black_box")
        os.ftruncate(memory, size)
        self.block = mmap.mmap(memory, size)
        reading, self._pipe = os.pipe()
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-I", "-m", __name__, str(memory), str(reading), str(folder), str(kept)],
                pass_fds=(memory, reading),
                stdin=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is for the black box, which ends the guard
            )
        finally:
            os.close(reading)
            os.close(memory)

    def end(self) -> None:
        """End the guard without a file."""
        with suppress(BrokenPipeError):  # it was killed
            os.write(self._pipe, _CLEAN)
        os.close(self._pipe)
        self.process.wait(10.0)


def main(arguments: list[str]) -> int:
    """Wait for the end of the black box."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    name_process(RECORDING_GUARD)  # the host of a run whose supervisor was killed does not kill it while it writes
    memory, pipe, folder, kept = int(arguments[0]), int(arguments[1]), Path(arguments[2]), int(arguments[3])
    if os.read(pipe, 1) == _CLEAN:
        return 0
    from ur_nodes.black_box.recording_file import RecordingError, write_recording
    from ur_nodes.black_box.ring import Ring
    from ur_nodes.black_box.tape import read_tape

    with mmap.mmap(memory, os.fstat(memory).st_size) as block, memoryview(block) as view:
        tape = tuple(read_tape(Ring(view, kept=True)))
        if not tape:
            return 0  # it ended before it had anything
        reason = "the process of the black box was killed"
        try:
            path = write_recording(folder, tape, [reason], time.time_ns() - time.monotonic_ns(), kept)
        except (RecordingError, ImportError) as problem:
            sys.stderr.write(f"error: the black box was killed, and its memory is not written: {problem}\n")
            return 1
    sys.stderr.write(f"black box: {path}: {reason}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
