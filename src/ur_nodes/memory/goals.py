"""Goals on a bus: `serve_goals`, and a client of it for tests and programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ur_nodes.ports.actions import Goal, GoalTakers
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import PlacedPose

if TYPE_CHECKING:
    from ur_nodes.memory.node import MemoryNode


@dataclass(frozen=True, slots=True)
class GoalState:
    """The state of a goal: pending, active, succeeded, aborted or cancelled; `text` is for people."""

    id: str
    state: str
    text: str


@dataclass(frozen=True, slots=True)
class Cancel:
    """A client wants a goal to end."""

    id: str


class MemoryGoalHandle:
    """See `ports.actions.GoalHandle`."""

    def __init__(self, goal: Goal, tell: Callable[[GoalState], None], report: Callable[[PlacedPose], None]) -> None:
        self.goal = goal
        self.state = GoalState(goal.id, "pending", "")
        self._tell = tell
        self._report = report

    def accept(self) -> None:
        """See GoalHandle."""
        self._become("active", "")

    def refuse(self, text: str) -> None:
        """See GoalHandle."""
        self._become("aborted", text)

    def note(self, text: str) -> None:
        """See GoalHandle."""
        self.state = GoalState(self.goal.id, self.state.state, text)

    def report(self, pose: PlacedPose) -> None:
        """See GoalHandle."""
        self._report(pose)

    def succeed(self, text: str) -> None:
        """See GoalHandle."""
        self._become("succeeded", text)

    def abort(self, text: str) -> None:
        """See GoalHandle."""
        self._become("aborted", text)

    def cancel(self, text: str) -> None:
        """See GoalHandle."""
        self._become("cancelled", text)

    def _become(self, state: str, text: str) -> None:
        if self.state.state not in ("pending", "active"):
            raise ValueError(f"goal {self.goal.id} has ended already: {self.state.state}, not {state}")
        self.state = GoalState(self.goal.id, state, text)
        self._tell(self.state)


class MemoryGoalServer:
    """See `ports.actions.GoalServer`. Topics: ACTION/goal, /cancel, /state and /feedback."""

    def __init__(self, node: MemoryNode, action: str, takers: GoalTakers) -> None:
        self._takers = takers
        self._handles: dict[str, MemoryGoalHandle] = {}
        self._states = node.publish(f"{action}/state", GoalState, Quality.EVERY)
        self._feedback = node.publish(f"{action}/feedback", PlacedPose)
        node.subscribe(f"{action}/goal", Goal, self._take_goal, Quality.EVERY)
        node.subscribe(f"{action}/cancel", Cancel, self._take_cancel, Quality.EVERY)

    def publish_status(self) -> None:
        """See GoalServer."""
        for handle in self._handles.values():
            self._states.send(handle.state)

    def _take_goal(self, goal: Goal) -> None:
        if goal.id not in self._handles:
            self._handles[goal.id] = handle = MemoryGoalHandle(goal, self._states.send, self._feedback.send)
            self._takers.take_goal(handle)

    def _take_cancel(self, cancel: Cancel) -> None:
        handle = self._handles.get(cancel.id)
        if handle is not None and handle.state.state in ("pending", "active"):
            self._takers.take_cancel(handle)
