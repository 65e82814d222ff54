"""Actions and reports that the supervisor requests. Values only."""

from collections.abc import Iterable
from signal import SIGINT, SIGKILL, SIGTERM

from ur.run.supervisor.state import ExitStatus, RunPhase, State, TimeLimits, UnitState, UnitStatus
from ur.source.data_classes import dataclass, replace


@dataclass(frozen=True, slots=True)
class StartUnit:
    """Start the process of a unit."""

    name: str


@dataclass(frozen=True, slots=True)
class SignalUnit:
    """Send a signal to the process group of a unit."""

    name: str
    signum: int


@dataclass(frozen=True, slots=True)
class AwaitMaster:
    """Wait until the master answers; results in MasterAnswered or SetupFailed."""


@dataclass(frozen=True, slots=True)
class SetParameters:
    """Set the parameters on the master; results in ParametersSet or SetupFailed."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """Signal every remaining process; results in NothingLeft once there is none."""

    signum: int


@dataclass(frozen=True, slots=True)
class Unregister:
    """Remove registrations of the run's nodes from a master that continues; results in Unregistered."""


@dataclass(frozen=True, slots=True)
class ReportDeath:
    """Report that a unit ended. `restart_in` is set if it is restarted, `ends_run` if the run ends.

    `deaths` is set if it is not restarted because it died so often in a row. `evicted_by` is set if another node
    registered under its name, and names the origin of that node.
    """

    name: str
    status: ExitStatus
    reason: str | None = None
    restart_in: float | None = None
    ends_run: bool = False
    deaths: int = 0
    evicted_by: str = ""


@dataclass(frozen=True, slots=True)
class ReportRequest:
    """Report that a unit was stopped on request, or (`refused`) the reason why the request is refused."""

    name: str
    refused: str = ""


@dataclass(frozen=True, slots=True)
class ReportRevival:
    """Report that nodes are restarted because another master answers."""


@dataclass(frozen=True, slots=True)
class ReportMaster:
    """Report that the master no longer answers, or answers again."""

    lost: bool


@dataclass(frozen=True, slots=True)
class StartShare:
    """Have the robot start its nodes again, with a master if it has none; results in ShareStarted or ShareFailed."""


@dataclass(frozen=True, slots=True)
class ReportLink:
    """Report that the robot has not answered for `seconds`, or (`lost` false) that it answers again."""

    lost: bool
    seconds: float


@dataclass(frozen=True, slots=True)
class ReportPressure:
    """Report that units do not stop and get the next signal."""

    names: tuple[str, ...]
    signum: int


@dataclass(frozen=True, slots=True)
class ReportPlanned:
    """Report a line that the launch file prints."""

    text: str


@dataclass(frozen=True, slots=True)
class ReportStop:
    """Report the reason why the run ends. `failed` means that it could not start."""

    cause: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class Finish:
    """The run is over; this is its exit code."""

    exit_code: int


Action = (
    StartUnit
    | SignalUnit
    | AwaitMaster
    | SetParameters
    | StartShare
    | Sweep
    | Unregister
    | ReportDeath
    | ReportPressure
    | ReportRequest
    | ReportRevival
    | ReportMaster
    | ReportLink
    | ReportPlanned
    | ReportStop
    | Finish
)


Step = tuple[State, list[Action]]
SIGNALS = (SIGINT, SIGTERM, SIGKILL)  # in order of increasing strength

_ORDER = list(RunPhase)


def is_before(state: State, phase: RunPhase) -> bool:
    """True while the run has not reached a phase."""
    return _ORDER.index(state.phase) < _ORDER.index(phase)


def put_unit(state: State, changed: UnitState) -> State:
    """Return the state with one unit replaced."""
    place = state.places[changed.unit.name]
    return replace(state, units=(*state.units[:place], changed, *state.units[place + 1 :]))


def start_units(state: State, chosen: Iterable[UnitState], now: float) -> Step:
    """Start the waiting ones of these units."""
    actions: list[Action] = []
    for each in chosen:
        if each.status is UnitStatus.WAITING:
            state = put_unit(
                state, replace(each, status=UnitStatus.STARTING, since=now, due=None, reason="", held=False)
            )
            actions.append(StartUnit(each.unit.name))
    return state, actions


def signal_patience(limits: TimeLimits, pressure: int) -> float:
    """Return the time to wait, in s, after the signal that follows `pressure` others."""
    return (limits.interrupt, limits.terminate, 1.0)[pressure]
