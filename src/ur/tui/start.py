"""Choice and start of the interface in a separate process, so that the supervisor stays small: this imports little."""

from __future__ import annotations

import os
import signal
import socket
import sys
import termios
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Literal

from ur.run.host import restore_terminal, set_foreground
from ur.run.process.terminal import ignore_background_write

if TYPE_CHECKING:
    from ur.run.clients.protocol import Severity

Mode = Literal["full", "calm", "plain"]
LEAST_COLUMNS, LEAST_ROWS = 60, 15
PATIENCE = 8.0  # s for the interface to leave the screen; a busy computer needs a few


def choose_mode(*, terminal: bool, size: tuple[int, int], term: str, calm: bool, textual: bool) -> Mode:
    """Choose the interface: `plain` lines without a terminal (or a `dumb` one), `calm` on a small one, else `full`.

    `terminal`: keyboard and screen are the terminal of this process. `size` in columns and rows; `textual`: the library
    is installed.
    """
    if not terminal or term in ("", "dumb"):
        return "plain"
    columns, rows = size
    return "calm" if calm or not textual or columns < LEAST_COLUMNS or rows < LEAST_ROWS else "full"


def look_for_mode(environment: Mapping[str, str], *, calm: bool) -> Mode:
    """Return `choose_mode` for standard input and output."""
    from importlib.util import find_spec

    try:
        terminal = os.isatty(0) and os.isatty(1) and os.isatty(2) and os.tcgetpgrp(0) == os.getpgrp()
        size = os.get_terminal_size(1)
    except OSError:
        return "plain"
    found = (size.columns or 80, size.lines or 24)
    term = environment.get("TERM", "")
    return choose_mode(terminal=terminal, size=found, term=term, calm=calm, textual=find_spec("textual") is not None)


class InterfaceProcess:
    """The interface's process. Pass `link` to the run; call `close` when the run has ended."""

    def __init__(self, mode: Mode) -> None:
        ignore_background_write()
        self._attributes: list[object] = termios.tcgetattr(0)
        self.link, theirs = socket.socketpair()
        os.set_inheritable(theirs.fileno(), True)
        argv = [sys.executable, "-I", "-m", "ur.tui", mode, str(theirs.fileno())]
        self._pid = os.posix_spawn(sys.executable, argv, dict(os.environ), setsigdef=[signal.SIGTTOU])
        theirs.close()

    def note(self, severity: Severity, text: str) -> None:
        """Pass on a message from before the run; it becomes the first in the interface's log."""
        from ur.run.clients.protocol import Notice, dump_line  # imported late: only for a message

        with suppress(OSError):
            self.link.sendall(dump_line(Notice(severity, text)))

    def close(self) -> None:
        """Wait until it has left the screen (or end it), and restore the terminal."""
        with suppress(OSError):
            self.link.close()
        killed = not self._wait()
        set_foreground(0, os.getpgrp())
        restore_terminal(0, self._attributes, reset=killed)

    def _wait(self) -> bool:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            pid, status = os.waitpid(self._pid, os.WNOHANG)
            if pid:
                return status == 0
            time.sleep(0.01)
        os.kill(self._pid, signal.SIGKILL)
        os.waitpid(self._pid, 0)
        return False

    def __enter__(self) -> InterfaceProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
