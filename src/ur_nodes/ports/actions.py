"""Goals that take a while: drive to a pose. Upstream's actions of each middleware are codecs of this one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ur_nodes.ports.values import PlacedPose


@dataclass(frozen=True, slots=True)
class Goal:
    """A pose to drive to. `id` names it for its client, and carries what the client claims.

    Nothing is checked: numbers may be NaN or infinite; the yaw is NaN where the orientation is no rotation.
    """

    id: str
    target: PlacedPose


class GoalHandle(Protocol):
    """A goal that has arrived. It is accepted or refused once, and ends once."""

    goal: Goal

    def accept(self) -> None:
        """Say that it is pursued."""

    def refuse(self, text: str) -> None:
        """End a goal that was never pursued."""

    def note(self, text: str) -> None:
        """Say how it stands, with the next status: some are sent each second."""

    def report(self, pose: PlacedPose) -> None:
        """Say where the robot is."""

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
