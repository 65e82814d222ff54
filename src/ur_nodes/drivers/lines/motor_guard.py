"""The guard of a device's motors: a process that receives each command, and is started again when it was killed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib.resources import files

from ur.robot.base.own_drivers import GUARD_SOCKET
from ur.run.host.cgroup import find_group_above

StartGuard = Callable[[int, bytes, bytes], int]

_SOON = 2.0  # s in which a guard that systemd has started does not end unless it cannot run


def start_guard(device: int, stop: bytes, leave: bytes) -> int:
    """Start the process that watches over the motors; returns the end of the pipe to write its `m` and `r` to."""
    theirs, ours = os.pipe()
    program = (files(__package__) / "guard_program.py").read_text(encoding="utf-8")
    words = [str(theirs), str(device), stop.hex(), leave.hex(), find_group_above()]
    # Until the guard ignores what ends its driver: a new process has blocked what is blocked here.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
    try:
        subprocess.Popen(
            [sys.executable, "-I", "-S", "-c", program, *words],
            pass_fds=(theirs, device),
            start_new_session=True,  # it outlives what ends this process and its group
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(theirs)
    os.set_blocking(ours, False)
    return ours


def request_guard(path: str, device: int, stop: bytes, leave: bytes) -> int:
    """Have systemd start it in the unit whose socket has this path; see `start_guard`. Raises OSError."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as link:
        link.setblocking(False)
        link.connect(path)
        socket.send_fds(link, [f"{stop.hex()},{leave.hex()}".encode()], [device])
        return link.detach()


class MotorGuard:
    """The guard of an open device; `stop` and `leave` as those of LineSettings."""

    def __init__(
        self, device: int, stop: bytes, leave: bytes, start: StartGuard = start_guard, unit: str = GUARD_SOCKET
    ) -> None:
        """Start it; `start` does so where systemd has no unit for it, whose socket is `unit`. Raises OSError."""
        self._unit, self._given, self._start = unit, (device, stop, leave), start
        self._requested = -_SOON
        self._pipe = self._begin()

    def report(self, *, moving: bool) -> bool:
        """Report a command before it is sent, so that motors never turn without a guard. Raises OSError.

        Returns False where the guard was killed: the motors are stopped, and a new guard is started.
        """
        try:
            os.write(self._pipe, b"m" if moving else b"r")
        except BlockingIOError:
            return True  # it has more to read than it needs
        except ConnectionError:
            device, stop, _ = self._given
            if moving:
                os.write(device, stop)  # first: a start takes time, and the host may have been killed, too
            started = self._begin()
            self.close()
            self._pipe = started
            return False
        return True

    def _begin(self) -> int:
        before, self._requested = self._requested, time.monotonic()
        if self._requested - before >= _SOON:
            with suppress(OSError):
                return request_guard(self._unit, *self._given)
        return self._start(*self._given)

    def close(self) -> None:
        """Let it stop the motors, leave the device and end."""
        os.close(self._pipe)
