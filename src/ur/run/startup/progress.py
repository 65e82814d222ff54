"""Progress of a start: readiness of nodes while somebody asks for it, and durations for `--timings`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ur.run.supervisor.model import Phase, State, Status

if TYPE_CHECKING:
    from ur.run.clients.monitor import Monitor
    from ur.run.inbox import Inbox
    from ur.run.run import Run
    from ur.run.startup.readiness import ReadinessProbe


class Progress:
    """Follows a run from its first process until all is up, and again whenever nodes come back."""

    def __init__(self, run: Run, inbox: Inbox, monitor: Monitor, inform: Callable[[str], None]) -> None:
        self._master = run.master
        self._conditions = {program.unit.name: program.ready for program in run.programs}
        self._timings = run.timings
        self._inbox = inbox
        self._monitor = monitor
        self._inform = inform
        self._probe: ReadinessProbe | None = None
        self._state: State | None = None

    def mark(self, step: str) -> None:
        """A step of the start has ended."""
        if self._timings is not None:
            self._timings.mark(step)

    def follow(self, state: State) -> None:
        """Check the readiness of the nodes of this state while a client asks for it."""
        self._state = state
        wanted = (self._monitor.wants_readiness or self._timings is not None) and state.phase is Phase.RUNNING
        if self._probe is None and wanted and self._master is not None:
            from ur.run.startup.readiness import ReadinessProbe  # only for those who wait

            self._probe = ReadinessProbe(self._master, self._conditions, self._hear)
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

    def note_started(self, name: str) -> None:
        """A node has a process."""
        self._time(name, up=False)

    def close(self) -> None:
        """Stop checking."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None

    def _hear(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        self._inbox.post(lambda: self._note_readiness(name, pid, missing))  # it speaks in a thread of its own

    def _note_readiness(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        each = None if self._state is None else self._state.find(name)
        if each is None or each.pid != pid:
            return  # that was another process of this name
        self._monitor.note_readiness(name, missing)
        self._time(name, up=not missing)

    def _time(self, name: str, *, up: bool) -> None:
        timings, state = self._timings, self._state
        if timings is None or state is None:
            return
        from ur.run.startup.timings import describe_timings, read_clock

        (timings.up if up else timings.started).setdefault(name, read_clock())
        if all(each.unit.core or each.status is Status.ENDED or each.unit.name in timings.up for each in state.units):
            self._timings = None
            self._inform("\n".join(describe_timings(timings.born, timings.steps, timings.started, timings.up)))
