"""A pseudo-terminal for a user interface that runs in this process, and a bus beside it."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterator
from types import TracebackType

from ur_nodes.memory.bus import Bus
from ur_nodes.teleop.terminal.raw import RawTerminal, own_terminal

LIMIT = 60.0  # s


class TypedTerminal:
    """Runs `body(terminal, ended)` on a thread; a test types, and reads what is shown. Leaving it ends the body."""

    def __init__(self, body: Callable[[RawTerminal, threading.Event], object]) -> None:
        self.ended = threading.Event()
        self.text = ""
        """All that was written on the terminal."""
        self._user, self._program = os.openpty()
        self._body = body
        self._threads = [threading.Thread(target=self._run), threading.Thread(target=self._read, daemon=True)]

    def __enter__(self) -> TypedTerminal:
        for thread in self._threads:
            thread.start()
        self.wait_for("\x1b[?u")  # what is typed before the terminal is in raw mode is lost
        return self

    def __exit__(self, _kind: type | None, _value: BaseException | None, _trace: TracebackType | None) -> None:
        self.ended.set()
        self._threads[0].join(LIMIT)
        os.close(self._program)
        self._threads[1].join(LIMIT)
        os.close(self._user)
        assert not self._threads[0].is_alive()

    def type(self, text: str | bytes) -> None:
        """Press keys."""
        os.write(self._user, text.encode() if isinstance(text, str) else text)

    def wait(self, condition: Callable[[], bool]) -> None:
        """Wait until a condition is true."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, f"the screen: {self.text[-500:]!r}"
            time.sleep(0.005)

    def wait_for(self, text: str) -> None:
        """Wait until a text has been shown."""
        self.wait(lambda: text in self.text)

    def wait_end(self) -> None:
        """Wait until the body has ended by itself."""
        self._threads[0].join(LIMIT)
        assert not self._threads[0].is_alive(), self.text[-500:]

    def _run(self) -> None:
        with own_terminal(self._program, self._program) as terminal:
            self._body(terminal, self.ended)

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # the terminal was closed: the end
            while data := os.read(self._user, 65536):
                self.text += data.decode(errors="replace")


@contextlib.contextmanager
def running(bus: Bus) -> Iterator[None]:
    """Let a bus run beside a user interface, about as fast as real time."""
    over = threading.Event()

    def run() -> None:
        while not over.wait(0.01):
            bus.run(0.01)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join(LIMIT)
