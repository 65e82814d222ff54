"""Goals over topics: for a middleware that has no action, or whose action's type is not installed.

ACTION/goal a Goal, ACTION/cancel a GoalId, ACTION/state each change of a goal, ACTION/status all goals, five times a
second, ACTION/feedback the place of the robot. ACTION_simple/goal takes a pose alone, as RViz sends it.
"""

from collections.abc import Callable
from typing import Literal, Protocol

from ur_nodes.ports.actions import Goal, GoalFollower, GoalHandlers, GoalId, GoalState, GoalStates
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedPose

_STATUS_PERIOD = 0.2  # s, as actionlib


class GoalReporter(Protocol):
    """Passes on what becomes of a goal that arrived by other means than a topic."""

    def report_state(self, state: GoalState) -> None:
        """The goal was accepted, or has ended."""

    def report_pose(self, pose: StampedPose) -> None:
        """The robot is at this pose."""


class TopicGoalHandle:
    """See `ports.actions.GoalHandle`."""

    def __init__(
        self, goal: Goal, arrived: int, report_state: Callable[[GoalState], None], report: Callable[[StampedPose], None]
    ) -> None:
        self.goal = goal
        self.arrived = arrived  # ns
        self.state = GoalState(goal.id, "pending", "")
        self._report_state = report_state
        self._report = report

    @property
    def open(self) -> bool:
        """Return whether the goal has not ended."""
        return self.state.open

    def accept(self) -> None:
        self._become("active", "")

    def refuse(self, text: str) -> None:
        self._become("aborted", text)

    def note(self, text: str) -> None:
        self.state = GoalState(self.goal.id, self.state.state, text)

    def report(self, pose: StampedPose) -> None:
        self._report(pose)

    def succeed(self, text: str) -> None:
        self._become("succeeded", text)

    def abort(self, text: str) -> None:
        self._become("aborted", text)

    def cancel(self, text: str) -> None:
        self._become("cancelled", text)

    def _become(self, state: Literal["active", "succeeded", "aborted", "cancelled"], text: str) -> None:
        if not self.open:
            raise ValueError(f"goal {self.goal.id} has ended already: {self.state.state}, not {state}")
        self.state = GoalState(self.goal.id, state, text)
        self._report_state(self.state)


class TopicGoalServer:
    """See `ports.actions.GoalServer`."""

    def __init__(self, node: Node, action: str, handlers: GoalHandlers, kept: float) -> None:
        self._node = node
        self._handlers = handlers
        self._kept = round(kept * 1e9)
        self._handles: dict[str, TopicGoalHandle] = {}
        self._ended: dict[str, int] = {}  # ns
        self._poses = 0
        self._states = node.publish(f"{action}/state", GoalState, Quality.EVERY)
        self._status = node.publish(f"{action}/status", GoalStates)
        self._feedback = node.publish(f"{action}/feedback", StampedPose)
        node.subscribe(f"{action}/goal", Goal, self._on_goal, Quality.EVERY)
        node.subscribe(f"{action}/cancel", GoalId, self._on_cancel, Quality.EVERY)
        node.subscribe(f"{action}_simple/goal", StampedPose, self._on_pose, Quality.EVERY)
        node.every(_STATUS_PERIOD, self.publish_status)

    def publish_status(self) -> None:
        now = self._node.now()
        for id, handle in list(self._handles.items()):
            if not handle.open and now - self._ended.setdefault(id, now) > self._kept:
                del self._handles[id], self._ended[id]
            else:
                self._states.send(handle.state)
        self._status.send(GoalStates(tuple(each.state for each in self._handles.values())))

    def handle_goal(self, goal: Goal, reporter: GoalReporter) -> None:
        """Take a goal that arrived by other means than a topic; clients on topics are informed of it, too."""

        def report_state(state: GoalState) -> None:
            self._states.send(state)
            reporter.report_state(state)

        def report(pose: StampedPose) -> None:
            self._feedback.send(pose)
            reporter.report_pose(pose)

        self._handle_handle(TopicGoalHandle(goal, self._node.now(), report_state, report))

    def cancel_goal(self, id: str) -> None:
        """Have the goal with this id end; where there is none, nothing happens."""
        self._on_cancel(GoalId(id))

    def _on_goal(self, goal: Goal) -> None:
        self._handle_handle(TopicGoalHandle(goal, self._node.now(), self._states.send, self._feedback.send))

    def _handle_handle(self, handle: TopicGoalHandle) -> None:
        if handle.goal.id not in self._handles:
            self._handles[handle.goal.id] = handle
            self._handlers.handle_goal(handle)

    def _on_pose(self, pose: StampedPose) -> None:
        self._poses += 1
        self._on_goal(Goal(f"{self._node.name}-{self._poses}-{self._node.now()}", pose))

    def _on_cancel(self, cancel: GoalId) -> None:
        for handle in list(self._handles.values()):
            meant = handle.goal.id == cancel.id or handle.arrived <= cancel.stamp or cancel == GoalId()
            if meant and handle.open:
                self._handlers.handle_cancel(handle)


class TopicGoalClient:
    """See `ports.actions.GoalClient`."""

    def __init__(
        self, node: Node, action: str, follower: GoalFollower, is_connected: Callable[[], bool] = lambda: True
    ) -> None:
        """`is_connected` tells whether a listener of goals is a server, and not only a recorder."""
        self._is_connected = is_connected
        self._connected = 0  # subscribers, when a server was among them
        self._goals = node.publish(f"{action}/goal", Goal, Quality.EVERY)
        self._cancels = node.publish(f"{action}/cancel", GoalId, Quality.EVERY)
        node.subscribe(f"{action}/status", GoalStates, self._on_states)
        node.subscribe(
            f"{action}/state", GoalState, lambda state: None if state.open else self._end(state), Quality.EVERY
        )
        self._follower = follower
        self._ended: set[str] = set()
        self.lists = 0
        """Lists of goals that servers have sent: recorders subscribe to goals, too, but send none."""

    def send(self, goal: Goal) -> None:
        self._goals.send(goal)

    def cancel(self, id: str = "") -> None:
        self._cancels.send(GoalId(id))

    def servers(self) -> int:
        subscribers = self._goals.subscribers()
        if subscribers != self._connected:
            self._connected = subscribers if subscribers and self._is_connected() else 0
        return self._connected

    def _on_states(self, states: GoalStates) -> None:
        self.lists += 1
        self._follower.on_states(states.goals)

    def _end(self, state: GoalState) -> None:
        if state.id not in self._ended:  # the server repeats it
            self._ended.add(state.id)
            self._follower.on_goal_end(state)
