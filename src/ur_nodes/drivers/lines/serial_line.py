"""A serial device, or one behind TCP, as a line: it is opened, read, and opened again when it was unplugged."""

import contextlib
import os
import select
import signal
import socket
import subprocess
import sys
import termios
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from typing import Protocol
from urllib.parse import urlsplit

import serial

from ur.robot.base.own_drivers import GUARD_SOCKET
from ur.run.host.cgroup import find_group_above
from ur_nodes.drivers.lines.line import LineSettings, LineUser, explain_error
from ur_nodes.ports.node import Node

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


SCHEME = "tcp://"
_PATIENCE = 2.0  # s until a device that does not answer is given up


def open_socket(address: str) -> socket.socket | str:
    """Connect to `tcp://HOST:PORT`; or why that failed. What is sent and not taken for _PATIENCE breaks the line."""
    try:
        parts = urlsplit(address)
        port = parts.port
        if not parts.hostname or port is None:
            return "no address of a device, expected tcp://HOST:PORT"
        connected = socket.create_connection((parts.hostname, port), timeout=_PATIENCE)
    except (OSError, ValueError) as problem:
        return "it does not answer" if isinstance(problem, TimeoutError) else explain_error(problem)
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(_PATIENCE * 1000))
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connected.setblocking(False)
    return connected


_PAUSE = 0.3  # s between two attempts to open it
_LOOK = 0.1  # s in which a reading that waits notices the end
_MOST = 65536


class OpenLine(Protocol):
    """A serial port or a socket."""

    def fileno(self) -> int:
        """The number of its open file."""

    def close(self) -> None:
        """Close it."""


@dataclass(frozen=True, slots=True)
class _Read:
    """The bytes that arrived, when they did (ns), and why the line is lost; '': it is not."""

    data: bytes = b""
    stamp: int = 0
    lost: str = ""


class SerialLine:
    """See DeviceLine. A guard process with the same device stops the motors when this process dies or stalls."""

    def __init__(
        self, node: Node, path: str, user: LineUser, settings: LineSettings, guard: StartGuard = start_guard
    ) -> None:
        """Begin to open it; `guard` starts its guard: see `start_guard`."""
        self.name = path
        self._node, self._user, self._settings, self._start_guard = node, user, settings, guard
        self._port: OpenLine | None = None
        self._guard: MotorGuard | None = None
        self._reported = ""  # why it is not open
        self._closed = False
        self._open()

    def write(self, data: bytes, *, moving: bool = False) -> None:
        if self._port is None or not data:
            return
        with contextlib.suppress(OSError, termios.error):  # unplugged: what reads it reports that
            if moving and not self._guarded(moving=True):
                return  # the next command moves them again
            os.write(self._port.fileno(), data)  # what stops motors waits for no guard that has to be started again
            if not moving:
                self._guarded(moving=False)

    def _guarded(self, *, moving: bool) -> bool:
        """Report to the guard, and log where it had to be started again."""
        guarded = self._guard is None or self._guard.report(moving=moving)
        if not guarded:
            self._node.log.warn(f"{self.name}: the guard of the motors was killed or hung; started another", every=60.0)
        return guarded

    def close(self) -> None:
        self._closed = True
        if self._port is not None:
            with contextlib.suppress(OSError, termios.error):
                termios.tcdrain(self._port.fileno())
            self._drop()

    def _open(self) -> None:
        if not self._closed:
            self._node.work(partial(open_port, self.name, self._settings), self._on_port, self.name)

    def _on_port(self, opened: OpenLine | str) -> None:
        if isinstance(opened, str):
            self._lose(opened)
            return
        self._port, self._reported = opened, ""
        if self._closed:
            self._drop()
            return
        stop, shutdown = self._settings.stop, self._settings.shutdown
        self._guard = MotorGuard(opened.fileno(), stop, shutdown, self._start_guard) if stop else None
        self._user.opened()
        self._read(opened.fileno())

    def _read(self, number: int) -> None:
        self._node.work(partial(_read, number, self._settings.batch, self._node.now), self._on_read, self.name)

    def _on_read(self, read: _Read) -> None:
        if self._port is None:
            return
        if read.lost:
            self._drop()
            self._lose(read.lost)
            return
        number = self._port.fileno()
        if read.data:
            self._user.received(read.data, read.stamp)
        if self._port is not None:
            self._read(number)

    def _lose(self, reason: str) -> None:
        if self._closed:
            return
        if reason != self._reported:
            self._reported = reason
            self._user.lost(reason)
        self._node.after(_PAUSE, self._open, steady=True)

    def _drop(self) -> None:
        """Close the device, and let the guard end."""
        port, guard, self._port, self._guard = self._port, self._guard, None, None
        with contextlib.suppress(OSError, termios.error):
            if port is not None:
                port.close()
        if guard is not None:
            guard.close()


def open_port(path: str, settings: LineSettings) -> OpenLine | str:
    """Open a device; or why it cannot be."""
    if path.startswith(SCHEME):
        return open_socket(path)
    try:
        port = serial.Serial(baudrate=settings.baud, timeout=0, exclusive=True)
        port.port, port.dtr = path, settings.dtr
        port.open()
    except (OSError, termios.error, ValueError) as problem:  # SerialException is an OSError
        return explain_error(problem)
    return port


def _read(number: int, batch: float, now: Callable[[], int]) -> _Read:
    """Wait a moment for bytes of a device."""
    try:
        if not select.select([number], [], [], _LOOK)[0]:
            return _Read()
        time.sleep(batch)
        data = os.read(number, _MOST)
        return _Read(data, now(), "" if data else "it was unplugged")
    except (OSError, ValueError) as problem:
        return _Read(lost=explain_error(problem))
