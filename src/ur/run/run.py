"""A run: programs, limits, clients; all settings that the loop needs."""

from __future__ import annotations

import socket
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ur.run.output.log_rotation import LogBounds
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event
from ur.run.supervisor.state import Planned, TimeLimits
from ur.source.data_classes import dataclass, field

if TYPE_CHECKING:
    from ur.run.clients.protocol import RunStarted
    from ur.run.middleware.protocol import Middleware
    from ur.run.record.registry import RunEntry

Job = Callable[[], Event]


@dataclass(frozen=True, slots=True)
class RunClients:
    """Clients and outputs of a run's events.

    `call_started` is called when every node has been started. `record_end` is called at the end: exit code, cause, last
    lines of the run itself, log files of its nodes. `report_event` passes on what has happened to a node. `viewer` is
    the run's end of a socket pair whose other end displays the run on this terminal: while it is open the console is
    silent. `events` is an open file that gets every event, in place of the console. `unattended`: no user sees the
    console.
    """

    describe: Callable[[], RunStarted] | None = None
    listener: socket.socket | None = None
    viewer: socket.socket | None = None
    events: int | None = None
    unattended: bool = False
    call_started: Callable[[], None] | None = None
    record_end: Callable[[int, str, Sequence[str], dict[str, str]], None] | None = None
    report_event: Callable[[str], object] | None = None


@dataclass(frozen=True, slots=True)
class Run:
    """Programs to run and their settings.

    `folder` is for the log files, `home` is the nodes' working directory. `await_master`, `set_parameters` and
    `unregister` communicate with the middleware and return the event that follows; they are called in a separate
    thread, so that a slow network does not delay the loop.
    """

    programs: tuple[UnitProgram, ...]
    folder: str
    home: str
    own_master: bool
    await_master: Job
    set_parameters: Job
    unregister: Job
    limits: TimeLimits = field(default_factory=TimeLimits)
    log_name: str = ""  # the stem of the log of the run itself, where that is detached
    log_bounds: LogBounds = field(default_factory=LogBounds)
    restart_share: Callable[[], Event] | None = None  # StartShare; None: no robot has a share
    middleware: Middleware | None = None  # returns which nodes are ready, while a client requests it
    simulated_time: bool = False  # nodes wait for /clock
    planned: tuple[Planned, ...] = ()  # what events start, print or end
    clients: RunClients = field(default_factory=RunClients)
    owners: tuple[RunEntry, ...] = ()  # runs that this one has joined: it ends with the first of them
    list_joined: Callable[[], Sequence[str]] | None = None  # the ids of the runs that have joined this one

    @property
    def terminal_program(self) -> UnitProgram | None:
        """Return the program that owns the keyboard and the screen."""
        return next((each for each in self.programs if each.unit.terminal), None)
