"""Progress of a start: readiness of nodes while a client requests it."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from ur.run.output.console import Console
from ur.run.process.terminal import Terminal
from ur.run.supervisor.actions import is_before
from ur.run.supervisor.events import Event, Started
from ur.run.supervisor.state import RunPhase, State

if TYPE_CHECKING:
    from ur.run.clients.monitor import Monitor
    from ur.run.run import Run
    from ur.run.startup.readiness import ReadinessProbe

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


class StartProgress:
    """Follows a run from its first process until all nodes are ready, and again whenever nodes restart."""

    def __init__(
        self, run: Run, post: Callable[[Callable[[], None]], None], monitor: Monitor, count: StartCount | None
    ) -> None:
        """Create the progress; `count` is shown while a program waits for the terminal."""
        self._middleware = run.middleware
        self._conditions = {program.unit.name: program.ready for program in run.programs}
        self._post = post
        self._monitor = monitor
        self._count = count
        self._probe: ReadinessProbe | None = None
        self._state: State | None = None

    def note(self, event: Event, state: State) -> None:
        """Process an event, with the state of the run after it."""
        if self._count is not None and isinstance(event, Started) and event.name == self._count.name:
            self._count.begin(event.pid, time.monotonic())
        self.follow(state)

    def follow(self, state: State) -> None:
        """Check the readiness of the nodes of this state while a client requests it."""
        self._state = state
        if self._count is not None and not is_before(state, RunPhase.STOPPING_NODES):
            self._count.stop()
        asked = self._monitor.wants_readiness or self.due is not None
        wanted = asked and state.phase is RunPhase.RUNNING
        if self._probe is None and wanted and self._middleware is not None:
            from ur.run.startup.readiness import ReadinessProbe  # imported late: only if a client waits

            self._probe = ReadinessProbe(self._middleware.view, self._conditions, self._take_readiness)
        if self._probe is not None and not wanted:
            self.close()
        if self._probe is not None:
            self._probe.follow(
                {
                    each.unit.name: each.pid
                    for each in state.units
                    if each.pid is not None and not each.unit.core and each.request is None
                }
            )

    @property
    def due(self) -> float | None:
        """Return the time of the next call of `work` (monotonic, s); None if none is due."""
        return None if self._count is None else self._count.due

    def work(self, now: float) -> None:
        """Show the number of ready nodes if that is due, and stop checking if no client requests it."""
        if self._count is None or self._count.due is None:
            return
        self._count.work(now)
        if self._count.due is None and self._state is not None:
            self.follow(self._state)

    def stop_count(self) -> None:
        """Stop the count, because the terminal is in use."""
        if self._count is not None:
            self._count.stop()

    def close(self) -> None:
        """Stop checking."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None

    def _take_readiness(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        self._post(lambda: self._note_readiness(name, pid, missing))  # it reports from a separate thread

    def _note_readiness(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        each = None if self._state is None else self._state.find(name)
        if each is None or each.pid != pid:
            return  # it was an earlier process of this name
        self._monitor.note_readiness(name, missing)
        if self._count is not None:
            self._count.note(name, up=not missing)
