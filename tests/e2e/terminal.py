"""A terminal for a test: a program on a pseudo-terminal of its own, what it shows, and what a person types."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import signal
import struct
import subprocess
import termios
import threading
import time
from collections.abc import Mapping, Sequence
from types import TracebackType

_SEQUENCE = re.compile(rb"\x1b(\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(\x07|\x1b\\)|[()].|.)")
_KEY_REPEAT = 0.04  # s


class ProgramTerminal:
    """Runs a command until the end of the `with`; then it and what it started are killed."""

    def __init__(self, command: Sequence[str], env: Mapping[str, str], columns: int = 100, rows: int = 30) -> None:
        self._user, program = os.openpty()
        fcntl.ioctl(program, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.process = subprocess.Popen(
            command,
            env={**env, "TERM": "xterm-256color"},
            stdin=program,
            stdout=program,
            stderr=program,
            start_new_session=True,
        )
        os.close(program)
        self._shown = b""
        self._held = b""
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=self._read, daemon=True), threading.Thread(target=self._hold)]
        for thread in self._threads:
            thread.start()

    def __enter__(self) -> ProgramTerminal:
        return self

    def __exit__(self, _kind: type | None, _value: BaseException | None, _trace: TracebackType | None) -> None:
        self.kill()
        self._ended.set()
        self._threads[1].join()
        os.close(self._user)

    def kill(self) -> None:
        """SIGKILL to the program and to all that it started; returns when it is dead."""
        import psutil

        with contextlib.suppress(psutil.NoSuchProcess):
            for child in psutil.Process(self.process.pid).children(recursive=True):
                with contextlib.suppress(psutil.NoSuchProcess):
                    child.send_signal(signal.SIGKILL)
        self.process.kill()
        self.process.wait()

    def type(self, text: str) -> None:
        """Press keys, one after another."""
        os.write(self._user, text.encode())

    def hold(self, key: str) -> None:
        """Hold a key down from now on, as a terminal tells it: over and over; '' lets go."""
        self._held = key.encode()

    @property
    def text(self) -> str:
        """All that was shown so far, without colours and places."""
        return _SEQUENCE.sub(b"", self._shown).decode(errors="replace")

    def forget(self) -> None:
        """Forget all that was shown so far."""
        self._shown = b""

    def wait_for(self, text: str, seconds: float = 150.0) -> None:
        """Until a text was shown since the last call."""
        end = time.monotonic() + seconds
        while text not in self.text:
            assert time.monotonic() < end, f"not shown: {text!r}; shown: {self.text[-2000:]!r}"
            assert self.process.poll() is None, f"the program has ended; shown: {self.text[-2000:]!r}"
            time.sleep(0.02)
        self._shown = b""

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # nobody has the other end any more
            while data := os.read(self._user, 65536):
                self._shown += data

    def _hold(self) -> None:
        while not self._ended.wait(_KEY_REPEAT):
            with contextlib.suppress(OSError):
                os.write(self._user, self._held)
