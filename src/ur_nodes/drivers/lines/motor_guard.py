"""The guard of a device's motors: a process that receives each command, and is started again when it was killed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from importlib.resources import files

StartGuard = Callable[[int, bytes, bytes], int]


def start_guard(device: int, stop: bytes, leave: bytes) -> int:
    """Start the process that watches over the motors; returns the end of the pipe to write its `m` and `r` to."""
    theirs, ours = os.pipe()
    program = (files(__package__) / "guard_program.py").read_text(encoding="utf-8")
    try:
        subprocess.Popen(
            [sys.executable, "-I", "-S", "-c", program, str(theirs), str(device), stop.hex(), leave.hex()],
            pass_fds=(theirs, device),
            start_new_session=True,  # it outlives what ends this process and its group
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    finally:
        os.close(theirs)
    os.set_blocking(ours, False)
    return ours


class MotorGuard:
    """The guard of an open device; `stop` and `leave` as those of LineSettings."""

    def __init__(self, device: int, stop: bytes, leave: bytes, start: StartGuard = start_guard) -> None:
        """Start it. Raises OSError."""
        self._start = partial(start, device, stop, leave)
        self._pipe = self._start()

    def report(self, *, moving: bool) -> None:
        """Report a command before it is sent, so that motors never turn without a guard. Raises OSError."""
        data = b"m" if moving else b"r"
        try:
            os.write(self._pipe, data)
        except BlockingIOError:
            return  # it has more to read than it needs
        except BrokenPipeError:  # it was killed
            started = self._start()
            self.close()
            self._pipe = started
            os.write(started, data)

    def close(self) -> None:
        """Let it stop the motors, leave the device and end."""
        os.close(self._pipe)
