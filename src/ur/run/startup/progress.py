"""Progress of a start: readiness of nodes while a client requests it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from ur.run.startup.start_count import StartCount
from ur.run.supervisor.changes import is_before
from ur.run.supervisor.events import Event, Started
from ur.run.supervisor.state import RunPhase, State

if TYPE_CHECKING:
    from ur.run.clients.monitor import Monitor
    from ur.run.inbox import Inbox
    from ur.run.run import Run
    from ur.run.startup.readiness import ReadinessProbe


class StartProgress:
    """Follows a run from its first process until all nodes are ready, and again whenever nodes restart."""

    def __init__(self, run: Run, inbox: Inbox, monitor: Monitor, count: StartCount | None) -> None:
        """Create the progress; `count` is shown while a program waits for the terminal."""
        self._middleware = run.middleware
        self._conditions = {program.unit.name: program.ready for program in run.programs}
        self._inbox = inbox
        self._monitor = monitor
        self._count = count
        self._probe: ReadinessProbe | None = None
        self._state: State | None = None

    def note(self, event: Event, state: State) -> None:
        """Process an event, with the state of the run after it."""
        self.follow(state)
        each = state.find(event.name) if isinstance(event, Started) else None
        if each is not None and not each.unit.core and isinstance(event, Started):
            if self._count is not None and event.name == self._count.name:
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
        self._inbox.post(lambda: self._note_readiness(name, pid, missing))  # it reports from a separate thread

    def _note_readiness(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        each = None if self._state is None else self._state.find(name)
        if each is None or each.pid != pid:
            return  # it was an earlier process of this name
        self._monitor.note_readiness(name, missing)
        if self._count is not None:
            self._count.note(name, up=not missing)
