"""What the supervisor knows, what happens to it, and what it wants done: values only."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum


@dataclass(frozen=True, slots=True)
class Unit:
    """A process as the supervisor sees it: its name and what its end means, not how it is started.

    `core` units (the master and rosout) start before all others and stop after them. A `terminal` unit owns the
    keyboard and the screen: the run ends with it.
    """

    name: str
    core: bool = False
    required: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    terminal: bool = False


@dataclass(frozen=True, slots=True)
class ExitStatus:
    """How a process ended: `code` when it exited by itself, else `signal`; neither when it could not be started."""

    code: int | None = None
    signal: int | None = None

    @property
    def clean(self) -> bool:
        """Whether it exited with 0."""
        return self.code == 0

    @property
    def shell_code(self) -> int:
        """The exit code a shell would show: 128 + n for signal n, 127 for a process that never started."""
        if self.signal is not None:
            return 128 + self.signal
        return 127 if self.code is None else self.code


class Status(Enum):
    """Where a unit stands."""

    WAITING = "waiting"  # not started yet, or due to start again
    STARTING = "starting"  # asked for
    RUNNING = "running"
    ENDED = "ended"  # and will not be started again


class Wish(Enum):
    """What a person wants of a unit that is being stopped."""

    STOP = "stop"
    RESTART = "restart"


class Phase(Enum):
    """Where the run stands. Phases only go forward."""

    MASTER = "master"  # waiting for the master to answer
    PARAMETERS = "parameters"
    RUNNING = "running"
    STOPPING_NODES = "stopping nodes"
    STOPPING_CORE = "stopping core"
    SWEEPING = "sweeping"  # ending what nodes left behind
    UNREGISTERING = "unregistering"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class Limits:
    """How long each step may take, in s. The defaults stop everything within 5 s."""

    interrupt: float = 3.0  # from SIGINT to SIGTERM
    terminate: float = 1.0  # from SIGTERM to SIGKILL
    core: float = 0.6  # from SIGINT to SIGKILL of the master and of rosout together
    sweep: float = 0.3  # from SIGTERM to SIGKILL of what nodes left behind
    unregister: float = 1.0
    master: float = 15.0  # from start to answer of a master of our own
    quick_death: float = 10.0  # a unit that lived shorter than this is restarted ever more slowly
    longest_backoff: float = 30.0
    quick_deaths: int = 10  # in a row, after which a unit is not started again; 0: always again, as roslaunch does
    bad_inputs: int = 3  # the same for units that exit with 2: what they were given does not change by itself


@dataclass(frozen=True, slots=True)
class UnitState:
    """A unit and where it stands. `due` is when to start it again; times are those handed to `step`.

    `wish` is set while a person's wish is carried out; `pressure` and `deadline` then say how far (as in State).
    `held`: a person stopped it. `reason` is why it could not be started, or is not started again.
    """

    unit: Unit
    status: Status = Status.WAITING
    pid: int | None = None
    since: float = 0.0
    due: float | None = None
    quick_deaths: int = 0  # in a row
    restarts: int = 0
    exit: ExitStatus | None = None
    wish: Wish | None = None
    pressure: int = 0
    deadline: float | None = None
    held: bool = False
    reason: str = ""
    gave_up: bool = False

    @property
    def alive(self) -> bool:
        """Whether there is, or is about to be, a process."""
        return self.status in (Status.STARTING, Status.RUNNING)


@dataclass(frozen=True, slots=True)
class State:
    """The whole run. `cause` says why it ends; `pressure` counts the signals sent so far: 1 INT, 2 TERM, 3 KILL."""

    units: tuple[UnitState, ...]
    own_master: bool
    limits: Limits = field(default_factory=Limits)
    phase: Phase = Phase.MASTER
    deadline: float | None = None
    pressure: int = 0
    exit_code: int = 0
    cause: str | None = None
    reviving: bool = False  # parameters go up again, to a master that has lost them

    def find(self, name: str) -> UnitState | None:
        """The state of a unit, by name."""
        return next((each for each in self.units if each.unit.name == name), None)


# What happens.


@dataclass(frozen=True, slots=True)
class Begin:
    """The run starts."""


@dataclass(frozen=True, slots=True)
class MasterAnswered:
    """The master can be talked to."""


@dataclass(frozen=True, slots=True)
class ParametersSet:
    """Every parameter is on the master."""


@dataclass(frozen=True, slots=True)
class SetupFailed:
    """The master did not answer, or refused a parameter. `reason` is for people."""

    reason: str


@dataclass(frozen=True, slots=True)
class Started:
    """A unit has a process."""

    name: str
    pid: int


@dataclass(frozen=True, slots=True)
class StartFailed:
    """A unit could not be started. `reason` is for people."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class Exited:
    """A unit's process ended."""

    name: str
    status: ExitStatus


@dataclass(frozen=True, slots=True)
class StopRequested:
    """Someone wants the run to end; asking again makes it faster. `exit_code` is that of the run."""

    cause: str
    exit_code: int = 0


@dataclass(frozen=True, slots=True)
class StartWanted:
    """A person wants a unit to run."""

    name: str


@dataclass(frozen=True, slots=True)
class StopWanted:
    """A person wants a unit not to run; `kill` at once. The run goes on."""

    name: str
    kill: bool = False


@dataclass(frozen=True, slots=True)
class RestartWanted:
    """A person wants a unit to start anew."""

    name: str


@dataclass(frozen=True, slots=True)
class MasterLost:
    """The master does not answer any more."""


@dataclass(frozen=True, slots=True)
class MasterReturned:
    """The master that was lost answers again and has forgotten nothing."""


@dataclass(frozen=True, slots=True)
class MasterReplaced:
    """Another master answers in place of the one that was there: it knows neither parameters nor nodes."""


@dataclass(frozen=True, slots=True)
class Tick:
    """Time passed."""


@dataclass(frozen=True, slots=True)
class NothingLeft:
    """No process of the run exists any more, children of children included."""


@dataclass(frozen=True, slots=True)
class Unregistered:
    """Registrations of the run's nodes are gone from the master, or could not be removed."""


Event = (
    Begin
    | MasterAnswered
    | ParametersSet
    | SetupFailed
    | Started
    | StartFailed
    | Exited
    | StopRequested
    | StartWanted
    | StopWanted
    | RestartWanted
    | MasterLost
    | MasterReturned
    | MasterReplaced
    | Tick
    | NothingLeft
    | Unregistered
)

# What to do.


@dataclass(frozen=True, slots=True)
class Start:
    """Start the process of a unit."""

    name: str


@dataclass(frozen=True, slots=True)
class Signal:
    """Send a signal to the process group of a unit."""

    name: str
    signum: int


@dataclass(frozen=True, slots=True)
class AwaitMaster:
    """Find out when the master answers; then MasterAnswered or SetupFailed."""


@dataclass(frozen=True, slots=True)
class SetParameters:
    """Put the parameters on the master; then ParametersSet or SetupFailed."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """Signal every process that is left; NothingLeft once there is none."""

    signum: int


@dataclass(frozen=True, slots=True)
class Unregister:
    """Remove what is left of the run's nodes from a master that stays; then Unregistered."""


@dataclass(frozen=True, slots=True)
class TellDeath:
    """Tell people that a unit ended. `restart_in` is set when it comes again, `ends_run` when nothing goes on.

    `deaths` is set when it will not be started any more because it died so often in a row.
    """

    name: str
    status: ExitStatus
    reason: str | None = None
    restart_in: float | None = None
    ends_run: bool = False
    deaths: int = 0


@dataclass(frozen=True, slots=True)
class TellWish:
    """Tell people that a unit was stopped because someone wanted it, or (`refused`) why that is not done."""

    name: str
    refused: str = ""


@dataclass(frozen=True, slots=True)
class TellRevival:
    """Tell people that nodes start again because another master is there."""


@dataclass(frozen=True, slots=True)
class TellMaster:
    """Tell people that the master does not answer any more, or answers again."""

    lost: bool


@dataclass(frozen=True, slots=True)
class TellPressure:
    """Tell people that units do not stop and get the next signal."""

    names: tuple[str, ...]
    signum: int


@dataclass(frozen=True, slots=True)
class TellStop:
    """Tell people why the run ends now. `failed` when it could not even begin."""

    cause: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class Finish:
    """The run is over; this is its exit code."""

    exit_code: int


Action = (
    Start
    | Signal
    | AwaitMaster
    | SetParameters
    | Sweep
    | Unregister
    | TellDeath
    | TellPressure
    | TellWish
    | TellRevival
    | TellMaster
    | TellStop
    | Finish
)
