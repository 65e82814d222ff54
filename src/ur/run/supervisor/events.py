"""Events that the supervisor handles. Values only."""

from __future__ import annotations

from dataclasses import dataclass

from ur.run.supervisor.state import ExitStatus

CTRL_C = "Ctrl-C"
"""The cause of a StopRequested from the keyboard."""


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
class Evicted:
    """A unit's process ended because another node registered under its name. `by` is for people: who started that."""

    name: str
    status: ExitStatus
    by: str


@dataclass(frozen=True, slots=True)
class OwnerEnded:
    """A run that this one has joined ends, and the nodes that this run uses end with it. `cause` is for people."""

    cause: str


@dataclass(frozen=True, slots=True)
class StopRequested:
    """A client or signal asks the run to end; asking again makes it faster. `exit_code` is that of the run."""

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
    """A person wants a unit to start anew; this once with `prefix` in front of its program, in place of its own."""

    name: str
    prefix: tuple[str, ...] = ()


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
class RobotMasterLost:
    """The robot answers, and has reported no master for so long (s)."""

    seconds: float


@dataclass(frozen=True, slots=True)
class LinkLost:
    """Nothing has come from the robot for so long (s). Repeated while it lasts."""

    seconds: float


@dataclass(frozen=True, slots=True)
class LinkRestored:
    """The robot answers again after so long (s)."""

    seconds: float


@dataclass(frozen=True, slots=True)
class ShareStarted:
    """The robot's nodes run again, after its restart."""


@dataclass(frozen=True, slots=True)
class ShareFailed:
    """The robot's nodes have ended and could not be started again. `reason` is text for people, with a remedy."""

    reason: str


@dataclass(frozen=True, slots=True)
class Tick:
    """Time passed."""


@dataclass(frozen=True, slots=True)
class NothingLeft:
    """No process of the run exists any more, children of children included."""


@dataclass(frozen=True, slots=True)
class Unregistered:
    """Registrations of the run's nodes are removed from the master, or could not be removed."""


Event = (
    Begin
    | MasterAnswered
    | ParametersSet
    | SetupFailed
    | Started
    | StartFailed
    | Exited
    | Evicted
    | OwnerEnded
    | StopRequested
    | StartWanted
    | StopWanted
    | RestartWanted
    | MasterLost
    | MasterReturned
    | MasterReplaced
    | RobotMasterLost
    | LinkLost
    | LinkRestored
    | ShareStarted
    | ShareFailed
    | Tick
    | NothingLeft
    | Unregistered
)
