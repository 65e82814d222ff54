"""The guard of a device's motors: a process that receives each command, and is started again when it was killed."""

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

StartGuard = Callable[[int, bytes, bytes], tuple[int, int]]

_SOON = 2.0  # s in which a guard that systemd has started does not end unless it cannot run, and one may start up
_UNREAD = 0.2  # s without room for a report after which a guard has stopped
_ROOM = 8192  # bytes of the socket's buffer: some twenty reports


def start_guard(device: int, stop: bytes, shutdown: bytes) -> tuple[int, int]:
    """Start the process that watches over the motors; returns the end of the pipe for its `m` and `r`, and its id."""
    theirs, ours = os.pipe2(os.O_DIRECT | os.O_CLOEXEC)  # each report takes a page: a guard that stopped fills it soon
    program = (files(__package__) / "guard_program.py").read_text(encoding="utf-8")
    words = [str(theirs), str(device), stop.hex(), shutdown.hex(), find_group_above()]
    # Until the guard ignores what ends its driver: a new process has blocked what is blocked here.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
    try:
        process = subprocess.Popen(
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
    return ours, process.pid


def request_guard(path: str, device: int, stop: bytes, shutdown: bytes) -> tuple[int, int]:
    """Have systemd start it in the unit whose socket has this path; see `start_guard`. Raises OSError."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as link:
        link.setblocking(False)
        link.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _ROOM)
        link.connect(path)
        socket.send_fds(link, [f"{stop.hex()},{shutdown.hex()}".encode()], [device])
        return link.detach(), 0


class MotorGuard:
    """The guard of an open device; `stop` and `shutdown` as those of LineSettings."""

    def __init__(
        self, device: int, stop: bytes, shutdown: bytes, start: StartGuard = start_guard, unit: str = GUARD_SOCKET
    ) -> None:
        """Start it; `start` does so where systemd has no unit for it, whose socket is `unit`. Raises OSError."""
        self._unit, self._given, self._start = unit, (device, stop, shutdown), start
        self._requested = -_SOON
        self._pipe, self._pid = self._begin()
        self._read = self._requested

    def report(self, *, moving: bool) -> bool:
        """Report a command before it is sent, so that motors never turn without a guard. Raises OSError.

        Returns False where the guard was killed or does not read: the motors are stopped, and a new guard is started.
        """
        now = time.monotonic()
        try:
            os.write(self._pipe, b"m" if moving else b"r")
        except BlockingIOError:
            if now - self._read < _UNREAD or now - self._requested < _SOON:
                return True  # it has more to read than it needs
        except ConnectionError:
            self._pid = 0
        else:
            self._read = now
            return True
        device, stop, _ = self._given
        if moving:
            os.write(device, stop)  # first: a start takes time, and the host may have been killed, too
        if self._pid:  # one that goes on later would stop and leave the device
            with suppress(OSError):
                os.kill(self._pid, signal.SIGKILL)
        started = self._begin()
        self.close()
        self._pipe, self._pid = started
        return False

    def _begin(self) -> tuple[int, int]:
        before, self._requested = self._requested, time.monotonic()
        if self._requested - before >= _SOON:
            with suppress(OSError):
                return request_guard(self._unit, *self._given)
        return self._start(*self._given)

    def close(self) -> None:
        """Let it stop the motors, leave the device and end."""
        os.close(self._pipe)
