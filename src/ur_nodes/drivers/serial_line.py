"""A serial device as a line: a thread that opens it, reads it, and opens it again when it was unplugged."""

from __future__ import annotations

import contextlib
import os
import select
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Callable
from importlib.resources import files

import serial

from ur_nodes.drivers.line import LineSettings, LineUser
from ur_nodes.ports.node import Node

_PAUSE = 0.3  # s between two attempts to open it
_BATCH = 0.002  # s in which more bytes of the same message may come
_MOST = 65536


def start_guard(device: int, stop: bytes) -> int:
    """Start the process that watches over the motors; returns the end of the pipe to write its `m` and `r` to."""
    theirs, ours = os.pipe()
    program = (files(__package__) / "guard_program.py").read_text(encoding="utf-8")
    try:
        subprocess.Popen(
            [sys.executable, "-I", "-S", "-c", program, str(theirs), str(device), stop.hex()],
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


class SerialLine:
    """See DeviceLine. A guard process with the same device stops the motors when this process dies or stalls."""

    def __init__(
        self,
        node: Node,
        path: str,
        user: LineUser,
        settings: LineSettings,
        guard: Callable[[int, bytes], int] = start_guard,
    ) -> None:
        """Begin to open it; `guard` starts its guard: see `start_guard`."""
        self.name = path
        self._node, self._user, self._settings, self._start_guard = node, user, settings, guard
        self._port: serial.Serial | None = None
        self._guard: int | None = None  # the end of a pipe
        self._reported = ""  # why it is not open
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"line {path}", daemon=True)
        self._thread.start()

    def write(self, data: bytes, *, moving: bool = False) -> None:
        """See DeviceLine."""
        with self._lock, contextlib.suppress(OSError, termios.error):  # unplugged: the thread that reads reports it
            if self._port is not None and data:
                self._tell_guard(self._port.fileno(), moving=moving)
                os.write(self._port.fileno(), data)

    def close(self) -> None:
        """See DeviceLine."""
        with self._lock, contextlib.suppress(OSError, termios.error):
            if self._port is not None:
                termios.tcdrain(self._port.fileno())
        self._closing.set()
        self._thread.join(2.0)

    def _tell_guard(self, device: int, *, moving: bool) -> None:
        """Before what moves the motors is sent, so that they never turn without a guard. Raises OSError."""
        if self._guard is None:
            return
        try:
            os.write(self._guard, b"m" if moving else b"r")
        except BlockingIOError:
            return  # it has more to read than it needs
        except BrokenPipeError:  # it was killed
            os.close(self._guard)
            self._guard = None
            self._guard = self._start_guard(device, self._settings.stop)
            os.write(self._guard, b"m" if moving else b"r")

    def _run(self) -> None:
        while not self._closing.is_set():
            try:
                reason = self._serve()
            except (OSError, termios.error, ValueError) as problem:  # SerialException is an OSError
                reason = _explain(problem)
            if reason != self._reported and not self._closing.is_set():
                self._reported = reason
                self._post_lost(reason)
            self._closing.wait(_PAUSE)

    def _serve(self) -> str:
        """Open the device and read it until it is lost. Raises OSError, termios.error."""
        port = serial.Serial(baudrate=self._settings.baud, timeout=0, exclusive=True)
        port.port, port.dtr = self.name, self._settings.dtr
        with port:
            number = port.fileno()
            stop = self._settings.stop
            with self._lock:
                self._guard = self._start_guard(number, stop) if stop else None
                self._port = port
            self._reported = ""
            self._node.post(self._user.opened)
            try:
                return self._read(number)
            finally:
                with self._lock:
                    self._port = None
                    if self._guard is not None:
                        os.close(self._guard)
                        self._guard = None

    def _read(self, number: int) -> str:
        while not self._closing.is_set():
            if not select.select([number], [], [], 0.1)[0]:
                continue
            time.sleep(_BATCH)
            data = os.read(number, _MOST)
            stamp = self._node.now()
            if not data:
                return "it was unplugged"
            self._node.post(lambda data=data, stamp=stamp: self._user.received(data, stamp))  # type: ignore[misc]
        return ""

    def _post_lost(self, reason: str) -> None:
        self._node.post(lambda: self._user.lost(reason))


def _explain(problem: Exception) -> str:
    number = problem.errno if isinstance(problem, OSError) else problem.args[0] if problem.args else None
    return os.strerror(number).lower() if isinstance(number, int) else str(problem)
