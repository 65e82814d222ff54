"""A client of goals: over topics for a server of this project, else by Nav2's action `navigate_to_pose`.

The action's topics and services are used themselves, as they are specified (design.ros2.org, "Actions"): its status
lists the goals of all clients, and any client may ask how one ended. rclpy's own client knows its own goals only.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ur_nodes.ports.actions import Goal, GoalFollower, GoalPhase, GoalState
from ur_nodes.ros2.navigation.messages import fill_target, find_action, key_message, reason_of

if TYPE_CHECKING:
    from nav2_msgs.action import NavigateToPose
    from rclpy.node import Node
    from rclpy.task import Future

    from ur_nodes.goal_topics import TopicGoalClient

LIST_PERIOD = 0.2  # s, as `goal_topics`
_MOST = 1000  # goals of ours whose ids are remembered
_ALONE = 10  # beats
_SILENT = 25  # beats, between two lists of goals of a server
_RESULT_BEATS = 10  # in which the server gives the reason of a goal's end
_PHASES: Mapping[int, GoalPhase] = {
    GoalStatus.STATUS_ACCEPTED: "pending",
    GoalStatus.STATUS_EXECUTING: "active",
    GoalStatus.STATUS_CANCELING: "active",
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "cancelled",
}  # anything else was given up
_LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_REFUSED = "Nav2 refused the goal; is it active? (ros2 lifecycle get /bt_navigator)"


class Nav2Goals:
    """The goals of a server of `navigate_to_pose`, passed on while `used`.

    `post` makes calls on the node's thread, which uses this.
    """

    def __init__(
        self,
        node: Node,
        post: Callable[[Callable[[], None]], None],
        action: type[NavigateToPose],
        name: str,
        follower: GoalFollower,
    ) -> None:
        self._post, self._action, self._follower = post, action, follower
        self._goals = node.create_client(action.Impl.SendGoalService, f"{name}/_action/send_goal")
        self._results = node.create_client(action.Impl.GetResultService, f"{name}/_action/get_result")
        self._cancels = node.create_client(CancelGoal, f"{name}/_action/cancel_goal")
        self._ids: dict[bytes, str] = {}  # of goals of ours
        self._waiting: dict[str, GoalState] = {}  # goals of ours that the server has not listed yet
        self._listed: dict[str, GoalState] = {}
        self._recoveries: dict[str, int] = {}  # on the way to open goals
        self._ending: dict[
            str, tuple[GoalState, int]
        ] = {}  # goals that have ended, and for how long a reason is awaited
        self.used = self._there = False

        def on_status(message: GoalStatusArray) -> None:
            found = [(bytes(each.goal_info.goal_id.uuid), int(each.status)) for each in message.status_list]
            post(lambda: self._on_list(found))

        def on_feedback(message: NavigateToPose.Impl.FeedbackMessage) -> None:
            key, count = bytes(message.goal_id.uuid), max(0, int(message.feedback.number_of_recoveries))
            post(lambda: self._recoveries.update({self._id_of(key): count}))

        node.create_subscription(GoalStatusArray, f"{name}/_action/status", on_status, _LATCHED)
        feedback = action.Impl.FeedbackMessage
        node.create_subscription(feedback, f"{name}/_action/feedback", on_feedback, QoSProfile(depth=10))

    def servers(self) -> int:
        """Return whether a server accepts goals, as 1 or 0."""
        return int(self._goals.service_is_ready() and self._cancels.service_is_ready())

    def send(self, goal: Goal) -> None:
        key = uuid.uuid4().bytes
        self._ids[key] = goal.id
        while len(self._ids) > _MOST:
            del self._ids[next(iter(self._ids))]
        self._waiting[goal.id] = GoalState(goal.id, "pending", "")
        request = self._action.Impl.SendGoalService.Request()
        request.goal_id = key_message(key)
        fill_target(request.goal, goal.target)

        def on_answer(future: Future) -> None:
            accepted = bool(future.result().accepted)
            self._post(lambda: None if accepted else self._end(GoalState(goal.id, "aborted", _REFUSED)))

        self._goals.call_async(request).add_done_callback(on_answer)

    def cancel(self, id: str = "") -> None:
        known = [key for key, own in self._ids.items() if own == id]
        request = CancelGoal.Request()  # an empty one cancels all
        if id:
            request.goal_info.goal_id = key_message(known[-1] if known else _key_of(id))
        self._cancels.call_async(request)

    def beat(self) -> None:
        """Pass on the states of all goals; call it each LIST_PERIOD."""
        there = bool(self.servers())
        if self._there and not there:  # what it knew is lost
            self._waiting.clear()
            self._listed.clear()
            self._recoveries.clear()
            self._ending.clear()
        self._there = there
        for state, beats in list(self._ending.values()):
            if beats:
                self._ending[state.id] = (state, beats - 1)
            else:
                self._end(state)
        if there and self.used:
            self._follower.on_states((*map(self._describe, self._listed.values()), *self._waiting.values()))

    def _describe(self, state: GoalState) -> GoalState:
        """Return the state to pass on, with the reason of its end."""
        if state.id in self._ending:
            return GoalState(state.id, "active", "")
        return replace(state, recoveries=self._recoveries.get(state.id, 0)) if state.open else state

    def _on_list(self, found: Sequence[tuple[bytes, int]]) -> None:
        before, self._listed = self._listed, {}
        for key, status in found:
            id = self._id_of(key)
            old = before.get(id)
            known = old is not None or id in self._waiting
            state = GoalState(id, _PHASES.get(status, "aborted"), "")
            self._waiting.pop(id, None)
            if old is not None and not old.open:
                self._listed[id] = old
                continue
            self._listed[id] = state
            if not state.open:
                self._recoveries.pop(id, None)
                if known:  # else it ended before this node started
                    self._ending[id] = (state, _RESULT_BEATS)
                    self._ask_result(key, state)

    def _ask_result(self, key: bytes, state: GoalState) -> None:
        request = self._action.Impl.GetResultService.Request()
        request.goal_id = key_message(key)

        def on_answer(future: Future) -> None:
            text = reason_of(future.result().result)
            self._post(lambda: self._end(GoalState(state.id, state.state, text)) if state.id in self._ending else None)

        self._results.call_async(request).add_done_callback(on_answer)

    def _end(self, state: GoalState) -> None:
        self._waiting.pop(state.id, None)
        self._ending.pop(state.id, None)
        if state.id in self._listed:
            self._listed[state.id] = state
        if self.used:
            self._follower.on_goal_end(state)

    def _id_of(self, key: bytes) -> str:
        return self._ids.get(key) or key.hex()


class ActionGoalClient:
    """See `ports.actions.GoalClient`.

    A server on topics is ours: it reads from a goal who sent it, which an action cannot tell. So the action is used
    only where no server has listened on topics for a while. One that lists no goals does not count: it records.
    """

    def __init__(self, topics: TopicGoalClient, nav2: Nav2Goals) -> None:
        self._topics, self._nav2 = topics, nav2
        self._alone = 0  # beats for which only Nav2 was there
        self._lists = self._silent = 0  # lists on topics, and beats since the last one

    def send(self, goal: Goal) -> None:
        (self._nav2 if self._nav2.used else self._topics).send(goal)

    def cancel(self, id: str = "") -> None:
        (self._nav2 if self._nav2.used else self._topics).cancel(id)

    def servers(self) -> int:
        return self._nav2.servers() if self._nav2.used else self._topics.servers()

    def beat(self) -> None:
        """Determine the server, and pass on Nav2's goals; call it each LIST_PERIOD."""
        self._silent = self._silent + 1 if self._topics.lists == self._lists else 0
        self._lists = self._topics.lists
        served = bool(self._topics.servers()) and self._silent <= _SILENT
        self._alone = self._alone + 1 if self._nav2.servers() and not served else 0
        self._nav2.used = self._alone > _ALONE
        self._nav2.beat()


def follow_actions(
    node: Node, post: Callable[[Callable[[], None]], None], name: str, topics: TopicGoalClient, follower: GoalFollower
) -> ActionGoalClient | None:
    """Make a client that also finds Nav2's action of that full name; None if its messages are not installed."""
    action = find_action("NavigateToPose")
    if action is None:
        return None
    return ActionGoalClient(topics, Nav2Goals(node, post, action, name, follower))


def _key_of(id: str) -> bytes:
    """Return the key of another client's goal; a key of no goal if the id is not Nav2's."""
    try:
        key = bytes.fromhex(id)
    except ValueError:
        key = b""
    return key if len(key) == 16 else uuid.uuid4().bytes
