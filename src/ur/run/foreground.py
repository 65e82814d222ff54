"""The terminal while a node of the run owns it."""

from __future__ import annotations

import signal

from ur.run.host.protocol import FOREGROUND, GROUP
from ur.run.output.console import Console
from ur.run.process.host_client import ProcessHost
from ur.run.process.terminal import Terminal


class Foreground:
    """Lends keyboard and screen to the unit (if any) that needs them, and keeps the console quiet meanwhile."""

    def __init__(self, name: str | None, terminal: Terminal | None, console: Console, host: ProcessHost) -> None:
        """`name` is the unit that needs the terminal."""
        self._name = name
        self._terminal = terminal
        self._console = console
        self._host = host

    def lend(self) -> str:
        """Release the terminal for the unit, which is about to start; return the process group kind for its start."""
        self._console.hold()
        if self._terminal is None or not self._terminal.in_foreground():
            return GROUP
        self._terminal.mark_lent()
        return FOREGROUND

    def take_back(self, *, reset: bool) -> None:
        """Take the terminal back after the unit has ended; `reset` it after one that was killed."""
        if self._terminal is not None:
            self._terminal.take_back(reset=reset)
        self._console.release()

    def suspend(self, name: str, pid: int | None) -> None:
        """Stop this process with a unit that was stopped (Ctrl-Z), and continue with it (`pid`, if it still exists)."""
        if self._terminal is None or name != self._name:
            return
        self._terminal.take_back(reset=False)
        self._terminal.wait_suspended()
        if self._terminal.in_foreground() and pid is not None:
            self._terminal.lend(pid)
        self._host.signal_process(name, signal.SIGCONT)
