"""Goals that take a while: drive to a pose. Upstream's actions of each middleware are codecs of this one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from ur_nodes.ports.values import PlacedPose


@dataclass(frozen=True, slots=True)
class GoalId:
    """Names goals: the one with `id`. As a request to cancel also those sent up to `stamp` (ns); with neither, all."""

    id: str = ""
    stamp: int = 0


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to. `id` names it for its client, and carries what the client claims.

    Nothing is checked: numbers may be NaN or infinite; the yaw is NaN where the orientation is no rotation.
    """

    id: str
    target: PlacedPose


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
    """A goal that has arrived. It is accepted or refused once, and ends once."""

    goal: Goal

    def accept(self) -> None:
        """Report that it is pursued."""

    def refuse(self, text: str) -> None:
        """End a goal that was never pursued."""

    def note(self, text: str) -> None:
        """Report its progress, with the next status: some are sent each second."""

    def report(self, pose: PlacedPose) -> None:
        """Report the robot's pose."""

    def succeed(self, text: str) -> None:
        """End it: reached."""

    def abort(self, text: str) -> None:
        """End it: given up."""

    def cancel(self, text: str) -> None:
        """End it: cancelled, or replaced by another."""


class GoalTakers(Protocol):
    """The part of a node that takes goals."""

    def take_goal(self, handle: GoalHandle) -> None:
        """A goal has arrived."""

    def take_cancel(self, handle: GoalHandle) -> None:
        """Its client wants it to end; not called for a goal that has ended."""


class GoalServer(Protocol):
    """An action that is offered."""

    def publish_status(self) -> None:
        """Send the states of all goals now, and not with the next beat."""


class GoalFollower(Protocol):
    """The part of a node that sends goals, or watches those of others."""

    def take_states(self, states: tuple[GoalState, ...]) -> None:
        """All goals that the server knows, several times a second: open ones, and those that ended lately."""

    def take_goal_end(self, state: GoalState) -> None:
        """A goal has ended."""


class GoalClient(Protocol):
    """The other end of an action, for its goals and those of others."""

    def send(self, goal: Goal) -> None:
        """Send a goal; it replaces the one that is pursued."""

    def cancel(self, id: str = "") -> None:
        """Cancel a goal; '' means all."""

    def servers(self) -> int:
        """The number of nodes that take goals: one, or none."""
