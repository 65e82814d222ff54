"""Number of ready nodes, printed on a terminal that one node will own, until that node may have written to it."""

from __future__ import annotations

import os

from ur.run.output.console import Console
from ur.run.process.terminal import Terminal

_PERIOD = 0.2  # s between checks
_LONGEST = 60.0  # s
_SHELLS = ("sh", "dash", "bash")  # launchers that start the program itself, and read from pipes until then


class StartCount:
    """A line that is updated in place while the program that owns the terminal is loading, which takes seconds.

    It is updated only while the program has certainly written nothing: the modes of the terminal are unchanged, the
    process has written no output since its interpreter started, and no line was typed. The terminal is not read.
    """

    def __init__(self, name: str, total: int, terminal: Terminal, console: Console) -> None:
        """Print the line. `name` is the unit that will own the terminal, one of `total`."""
        self.name = name
        self.due: float | None = None
        """The time of the next call of `work` (monotonic, s); None: not any more, or not yet."""
        self._total, self._terminal, self._console = total, terminal, console
        self._up: set[str] = set()
        self._pid, self._end = 0, 0.0
        self._written: int | None = None  # bytes that the program had written when its interpreter started
        self._shown = self._describe()
        console.inform(self._shown)

    def begin(self, pid: int, now: float) -> None:
        """Record that the program has a process, and the terminal."""
        self._pid, self._end, self.due = pid, now + _LONGEST, now + _PERIOD

    def note(self, name: str, *, up: bool) -> None:
        """Record that a node is ready, or no longer ready."""
        (self._up.add if up else self._up.discard)(name)

    def stop(self) -> None:
        """Leave the line unchanged from now on."""
        self.due = None

    def work(self, now: float) -> None:
        """Update the line if that is due."""
        if self.due is None or now < self.due:
            return
        self.due = now + _PERIOD
        known = self._written is not None
        if now > self._end or not self._terminal.is_unused(self._pid) or not self._has_written_nothing():
            self.stop()
        elif known and self._up and (text := self._describe()) != self._shown:
            if self._console.replace(self._shown, text):
                self._shown = text
            else:
                self.stop()

    def _describe(self) -> str:
        count = f"{len(self._up)} of {self._total} up; " if self._up else ""
        return f"starting: {count}{self.name.rpartition('/')[2]} takes this terminal in a few seconds"

    def _has_written_nothing(self) -> bool:
        try:
            shell = os.path.basename(os.readlink(f"/proc/{self._pid}/exe")) in _SHELLS  # noqa: PTH115, PTH119 - as below
            with open(f"/proc/{self._pid}/io", encoding="ascii") as file:  # noqa: PTH123 - pathlib is not worth its import
                written = next(int(line[6:]) for line in file if line.startswith("wchar:"))
        except (OSError, ValueError, StopIteration):
            return False  # the process has ended, or belongs to another user
        if self._written is None and not shell:
            self._written = written
        return shell or written == self._written
