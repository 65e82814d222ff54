"""A serial device without hardware: a pseudo-terminal with a program at its other end, and faults."""

from __future__ import annotations

import contextlib
import os
import select
import termios
import threading
import tty
from pathlib import Path
from types import TracebackType
from typing import Protocol

_SPEEDS = {getattr(termios, name): int(name[1:]) for name in dir(termios) if name[:1] == "B" and name[1:].isdigit()}


class Firmware(Protocol):
    """The behaviour of a device. Called in one thread."""

    def receive(self, data: bytes) -> bytes:
        """The answer to what has come."""

    def tick(self) -> bytes:
        """What the device sends by itself, every few milliseconds."""


class SerialStandIn:
    """A device at `path`, a link as udev makes it; `with` plugs it in and unplugs it at the end.

    At another speed than `baud` both sides hear garbage, as on a wire. `noise` comes before each answer.
    """

    def __init__(self, path: Path, firmware: Firmware, baud: int, *, noise: bytes = b"") -> None:
        self.path, self.noise = path, noise
        self._firmware, self._baud = firmware, baud
        self._thread: threading.Thread | None = None

    def __enter__(self) -> SerialStandIn:
        self.plug()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.unplug()

    def plug(self) -> None:
        """Plug it in: it has another device file then, and the same link."""
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self._stop, self._wake = os.pipe()
        self.path.symlink_to(os.ttyname(self._theirs))
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def unplug(self) -> None:
        """Unplug it: whoever has it open reads an end or an error. May be called twice."""
        if self._thread is None:
            return
        os.write(self._wake, b"x")
        self._thread.join()
        self._thread = None
        self.path.unlink()
        for each in (self._ours, self._theirs, self._stop, self._wake):
            os.close(each)

    def _serve(self) -> None:
        while self._stop not in select.select([self._ours, self._stop], [], [], 0.005)[0]:
            try:
                data = os.read(self._ours, 256)
            except BlockingIOError:
                data = b""
            answer = self._firmware.receive(self._garble(data)) if data else b""
            self._send((self.noise + answer if answer else b"") + self._firmware.tick())

    def _send(self, data: bytes) -> None:
        with contextlib.suppress(BlockingIOError):  # nobody reads, and the line is full: lost, as on a wire
            os.write(self._ours, self._garble(data))

    def _garble(self, data: bytes) -> bytes:
        speed = _SPEEDS.get(termios.tcgetattr(self._theirs)[4])
        return data if speed == self._baud else bytes(each ^ 0xB5 for each in data)
