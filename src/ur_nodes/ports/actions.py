"""Goals to drive to a pose. The codecs of each middleware map them to upstream's actions."""

from dataclasses import dataclass
from typing import Literal, Protocol

from ur_nodes.ports.values import StampedPose


@dataclass(frozen=True, slots=True)
class GoalId:
    """The goal with `id`; in a request to cancel also goals sent up to `stamp` (ns), and with neither, all goals."""

    id: str = ""
    stamp: int = 0


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to. `id` names it for its client, and carries what the client claims.

    Numbers are unchecked and may be NaN or infinite; the yaw is NaN if the orientation is no rotation.
    """

    id: str
    target: StampedPose


GoalPhase = Literal["pending", "active", "succeeded", "aborted", "cancelled"]


@dataclass(frozen=True, slots=True)
class GoalState:
    """The state of a goal: cancelled ones were ended by a client, aborted ones given up; `text` is for people.

    `recoveries` is how often navigation has freed the robot on the way, where it reports that.
    """

    id: str
    state: GoalPhase
    text: str
    recoveries: int = 0

    @property
    def open(self) -> bool:
        """Return whether the goal has not ended."""
        return self.state in ("pending", "active")


@dataclass(frozen=True, slots=True)
class GoalStates:
    """The states of all goals that a server knows."""

    goals: tuple[GoalState, ...] = ()


class GoalHandle(Protocol):
    """A goal that a server has received. It is accepted or refused once, and ends once."""

    goal: Goal

    def accept(self) -> None:
        """Accept the goal, and report it as active."""

    def refuse(self, text: str) -> None:
        """Refuse the goal, which was never active."""

    def note(self, text: str) -> None:
        """Report progress as text, sent with the next status, several times a second."""

    def report(self, pose: StampedPose) -> None:
        """Report the robot's pose."""

    def succeed(self, text: str) -> None:
        """End the goal as reached."""

    def abort(self, text: str) -> None:
        """End the goal as given up."""

    def cancel(self, text: str) -> None:
        """End the goal as cancelled, or replaced by another."""


class GoalHandlers(Protocol):
    """The callbacks of a node that serves goals."""

    def handle_goal(self, handle: GoalHandle) -> None:
        """Take a goal that has arrived."""

    def handle_cancel(self, handle: GoalHandle) -> None:
        """Take the request of a client to cancel a goal; not called for a goal that has ended."""


class GoalServer(Protocol):
    """An action that is offered."""

    def publish_status(self) -> None:
        """Send the states of all goals now, before the next periodic message."""


class GoalFollower(Protocol):
    """The callbacks of a node that sends goals, or monitors those of others."""

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        """Take the states of open and recently ended goals; called several times a second."""

    def on_goal_end(self, state: GoalState) -> None:
        """Take the final state of a goal."""


class GoalClient(Protocol):
    """A client of an action, for its own goals and those of others."""

    def send(self, goal: Goal) -> None:
        """Send a goal, which replaces the active one."""

    def cancel(self, id: str = "") -> None:
        """Cancel a goal; '' cancels all."""

    def servers(self) -> int:
        """Return the number of servers of the action: one or none."""
