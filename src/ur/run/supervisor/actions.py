"""Actions and reports that the supervisor requests. Values only."""

from __future__ import annotations

from dataclasses import dataclass

from ur.run.supervisor.state import ExitStatus


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
class ReportDeath:
    """Report that a unit ended. `restart_in` is set when it is restarted, `ends_run` when the run ends.

    `deaths` is set when it will not be started any more because it died so often in a row. `evicted_by` is set when
    another node registered under its name: who started that.
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
    """Report that a unit was stopped on request, or (`refused`) why the request is not carried out."""

    name: str
    refused: str = ""


@dataclass(frozen=True, slots=True)
class ReportRevival:
    """Report that nodes are restarted because another master answers."""


@dataclass(frozen=True, slots=True)
class ReportMaster:
    """Report that the master does not answer any more, or answers again."""

    lost: bool


@dataclass(frozen=True, slots=True)
class StartShare:
    """Have the robot start its nodes again, with a master where it has none; then ShareStarted or ShareFailed."""


@dataclass(frozen=True, slots=True)
class ReportLink:
    """Report that nothing has come from the robot for so long (s), or (`lost` false) that it answers again."""

    lost: bool
    seconds: float


@dataclass(frozen=True, slots=True)
class ReportPressure:
    """Report that units do not stop and get the next signal."""

    names: tuple[str, ...]
    signum: int


@dataclass(frozen=True, slots=True)
class ReportStop:
    """Report why the run ends now. `failed` when it could not even begin."""

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
    | ReportStop
    | Finish
)
