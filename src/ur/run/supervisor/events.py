"""Events that the supervisor handles. Values only."""

from ur.run.supervisor.state import ExitStatus
from ur.source.data_classes import dataclass

CTRL_C = "Ctrl-C"
"""The cause of a StopRequested from the keyboard."""


@dataclass(frozen=True, slots=True)
class Begin:
    """The run starts."""


@dataclass(frozen=True, slots=True)
class MasterAnswered:
    """The master answers."""


@dataclass(frozen=True, slots=True)
class ParametersSet:
    """Every parameter is on the master."""


@dataclass(frozen=True, slots=True)
class SetupFailed:
    """The master did not answer, or refused a parameter. `reason` is a text for the user."""

    reason: str


@dataclass(frozen=True, slots=True)
class Started:
    """A unit has a process."""

    name: str
    pid: int


@dataclass(frozen=True, slots=True)
class StartFailed:
    """A unit could not be started. `reason` is a text for the user."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class Exited:
    """A unit's process ended."""

    name: str
    status: ExitStatus


@dataclass(frozen=True, slots=True)
class Printed:
    """A unit printed something, which is reported only where an effect depends on it."""

    name: str


@dataclass(frozen=True, slots=True)
class Evicted:
    """A unit's process ended because another node registered under its name. `by` describes the origin of that node."""

    name: str
    status: ExitStatus
    by: str


@dataclass(frozen=True, slots=True)
class OwnerEnded:
    """A run that this one has joined ends, and the nodes that this run uses end with it.

    `cause` is a text for the user.
    """

    cause: str


@dataclass(frozen=True, slots=True)
class StopRequested:
    """A client or signal requests the end of the run; repeated requests end it faster.

    `exit_code` is that of the run.
    """

    cause: str
    exit_code: int = 0


@dataclass(frozen=True, slots=True)
class StartNode:
    """Start a node that has ended or waits. No effect on a running node."""

    name: str


@dataclass(frozen=True, slots=True)
class StopNode:
    """Stop a node and keep it stopped: SIGINT, SIGTERM, SIGKILL. The run continues, even if the node is required."""

    name: str


@dataclass(frozen=True, slots=True)
class RestartNode:
    """Stop a node and start it again."""

    name: str


@dataclass(frozen=True, slots=True)
class KillNode:
    """SIGKILL a node and keep it stopped."""

    name: str


@dataclass(frozen=True, slots=True)
class MasterLost:
    """The master no longer answers."""


@dataclass(frozen=True, slots=True)
class MasterReturned:
    """The lost master answers again and still has its state."""


@dataclass(frozen=True, slots=True)
class MasterReplaced:
    """Another master answers at the address: it has neither the parameters nor the nodes."""


@dataclass(frozen=True, slots=True)
class RobotMasterLost:
    """The robot answers, but has had no master for `seconds`."""

    seconds: float


@dataclass(frozen=True, slots=True)
class LinkLost:
    """The robot has not answered for `seconds`. Repeated while that lasts."""

    seconds: float


@dataclass(frozen=True, slots=True)
class LinkRestored:
    """The robot answers again after `seconds`."""

    seconds: float


@dataclass(frozen=True, slots=True)
class ShareStarted:
    """The robot's nodes run again, after its restart."""


@dataclass(frozen=True, slots=True)
class ShareFailed:
    """The robot's nodes have ended and could not be started again. `reason` is a text for the user, with a remedy."""

    reason: str


@dataclass(frozen=True, slots=True)
class Tick:
    """Time passed."""


@dataclass(frozen=True, slots=True)
class NothingLeft:
    """All processes of the run have ended, including their descendants."""


@dataclass(frozen=True, slots=True)
class Unregistered:
    """Registrations of the run's nodes are removed from the master, or could not be removed."""


NodeRequest = StartNode | StopNode | RestartNode | KillNode
"""What a user requests of one unit; also a command of clients (`ur.run.clients.protocol`)."""

Event = (
    Begin
    | MasterAnswered
    | ParametersSet
    | SetupFailed
    | Started
    | StartFailed
    | Exited
    | Printed
    | Evicted
    | OwnerEnded
    | StopRequested
    | NodeRequest
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
