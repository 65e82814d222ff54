"""State of a run: its units, and the status of each. Values only."""

from collections.abc import Mapping
from enum import Enum

from ur.launchfile.plan.specs import Trigger
from ur.source.data_classes import dataclass, field


@dataclass(frozen=True, slots=True)
class Unit:
    """A process as the supervisor sees it: its name and the consequences of its end, without its command.

    `core` units (the master and rosout) start before all others and stop after them. A `terminal` unit owns the
    keyboard and the screen: the run ends with it. `planned`: an event starts it, not the beginning of the run. It is
    restarted at most `retries` times, unless that is None. A `helper` does not keep a run going that has other units.
    """

    name: str
    core: bool = False
    required: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    terminal: bool = False
    planned: bool = False
    retries: int | None = None
    helper: bool = False

    @property
    def is_first(self) -> bool:
        """True if the unit starts with the run."""
        return not self.core and not self.planned


@dataclass(frozen=True, slots=True)
class ExitStatus:
    """The end of a process: `code` if it exited by itself, else `signal`; neither if it could not be started."""

    code: int | None = None
    signal: int | None = None

    @property
    def clean(self) -> bool:
        """True for an exit with code 0."""
        return self.code == 0

    @property
    def shell_code(self) -> int:
        """Return the exit code that a shell would show: 128 + n for signal n, 127 for a process that never started."""
        if self.signal is not None:
            return 128 + self.signal
        return 127 if self.code is None else self.code


class UnitStatus(Enum):
    """The status of a unit."""

    WAITING = "waiting"  # not started yet, or due to start again
    STARTING = "starting"  # asked for
    RUNNING = "running"
    ENDED = "ended"  # and will not be started again


class StopRequest(Enum):
    """A user's request for a unit that is being stopped."""

    STOP = "stop"
    RESTART = "restart"


class RunPhase(Enum):
    """The phase of a run. A run never returns to an earlier phase."""

    MASTER = "master"  # waiting for the master to answer
    PARAMETERS = "parameters"
    RUNNING = "running"
    STOPPING_NODES = "stopping nodes"
    STOPPING_CORE = "stopping core"
    SWEEPING = "sweeping"  # ending what nodes left behind
    UNREGISTERING = "unregistering"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """Time limits of the steps, in s. The defaults stop everything within 5 s."""

    interrupt: float = 3.0  # from SIGINT to SIGTERM
    terminate: float = 1.0  # from SIGTERM to SIGKILL
    core: float = 0.6  # from SIGINT to SIGKILL of the master and of rosout together
    sweep: float = 0.3  # from SIGTERM to SIGKILL of remaining processes of nodes
    unregister: float = 1.0
    master: float = 15.0  # from start to answer of this run's own master
    robot: float = 120.0  # for which a robot may answer without a master before the run ends
    quick_death: float = 10.0  # a unit that ran shorter than this is restarted with growing delays
    longest_backoff: float = 30.0
    quick_deaths: int = 10  # ends in a row, after which a unit is not restarted; 0: no limit, as in roslaunch
    failures_count: bool = False  # the run has exit code 1 after a required unit has failed; 0 in roslaunch
    bad_inputs: int = 3  # the same for units that exit with 2: their arguments do not change by themselves

    def is_storm(self, quick_deaths: int, status: ExitStatus) -> bool:
        """Return whether a unit that has died so often in a row is not restarted."""
        most = min(self.bad_inputs, self.quick_deaths) if status.code == 2 else self.quick_deaths
        return bool(self.quick_deaths) and quick_deaths >= most

    def backoff(self, quick_deaths: int) -> float:
        """Return the delay of a restart, in s. The first is as prompt as in roslaunch."""
        return 0.0 if quick_deaths < 2 else min(self.longest_backoff, 0.25 * 2.0 ** min(quick_deaths - 2, 16))


@dataclass(frozen=True, slots=True)
class UnitState:
    """A unit and its state.

    `due` is the time of its restart; times are those passed to `step`. `request` is set while a user's request is
    executed; `pressure` and `deadline` are its progress. `held`: the user stopped it. `reason` tells why it could not
    be started, or is not restarted.
    """

    unit: Unit
    status: UnitStatus = UnitStatus.WAITING
    pid: int | None = None
    since: float = 0.0
    due: float | None = None
    quick_deaths: int = 0  # ends in a row
    restarts: int = 0
    exit: ExitStatus | None = None
    request: StopRequest | None = None
    pressure: int = 0
    deadline: float | None = None
    held: bool = False
    reason: str = ""
    gave_up: bool = False

    @property
    def alive(self) -> bool:
        """True while the unit has a process, or is about to have one."""
        return self.status in (UnitStatus.STARTING, UnitStatus.RUNNING)

    @property
    def goes_on(self) -> bool:
        """True while the unit runs or will: one that waits for an event does not, where nothing is left to cause it."""
        waits = self.unit.planned and self.status is UnitStatus.WAITING and self.due is None
        return self.status is not UnitStatus.ENDED and not waits


@dataclass(frozen=True, slots=True)
class StartPlanned:
    """Start the unit `name`."""

    name: str


@dataclass(frozen=True, slots=True)
class PrintPlanned:
    """Print a line."""

    text: str


@dataclass(frozen=True, slots=True)
class EndPlanned:
    """End the run."""

    reason: str


@dataclass(frozen=True, slots=True)
class CancelPlanned:
    """Forget what an event handler has not caused yet; `handler` is that of its Trigger."""

    handler: int


Effect = StartPlanned | PrintPlanned | EndPlanned


@dataclass(frozen=True, slots=True)
class Planned:
    """An effect, and the events that have to occur before it, in this order. `due` is the time of a timer that runs."""

    effect: Effect | CancelPlanned
    triggers: tuple[Trigger, ...] = ()
    due: float | None = None


@dataclass(frozen=True, slots=True)
class State:
    """The whole run. `cause` is the reason of its end; `pressure` counts the sent signals: 1 INT, 2 TERM, 3 KILL."""

    units: tuple[UnitState, ...]
    own_master: bool
    limits: TimeLimits = field(default_factory=TimeLimits)
    phase: RunPhase = RunPhase.MASTER
    deadline: float | None = None
    pressure: int = 0
    exit_code: int = 0
    cause: str | None = None
    reviving: bool = False  # parameters are set again on a master that has lost them
    stale: bool = False  # they could not be set: the master was lost again
    shared: bool = False  # the robot has a share of the run, which this run restarts after the robot's restart
    planned: tuple[Planned, ...] = ()  # what events are still to cause
    effects: tuple[Effect, ...] = ()  # of the event that is handled
    places: Mapping[str, int] = field(default_factory=dict, compare=False, repr=False)  # in `units`, by name

    def find(self, name: str) -> UnitState | None:
        """Return the state of a unit by name, or None."""
        place = self.places.get(name)
        return None if place is None else self.units[place]
