"""The actions `navigate_to_pose` and `navigate_through_poses` for a server of goals, as Nav2 offers them.

A goal of theirs is a goal like those that arrive on topics: clients there are informed of it, too. Actions know no goal
that was replaced: it ends as aborted, as with Nav2. One that is refused is accepted and aborted: its client reads why.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup

from ur_nodes.goal_topics import TopicGoalServer
from ur_nodes.ports.actions import Goal, GoalState
from ur_nodes.ports.values import StampedPose
from ur_nodes.ros2.navigation.messages import fill_feedback, fill_result, find_action, targets_of

if TYPE_CHECKING:
    from nav2_msgs.action import NavigateToPose
    from rclpy.action.server import ServerGoalHandle
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

TO_POSE, THROUGH_POSES = "navigate_to_pose", "navigate_through_poses"
_KEPT = 10.0  # s, at least, in which a client may still ask how its goal ended: as rclcpp


class Pursuit:
    """A goal of an action, whose poses are goals of the server one after the other. Used on the node's thread."""

    def __init__(
        self,
        handle: ServerGoalHandle,
        feedback: NavigateToPose.Feedback,
        server: TopicGoalServer,
        now: Callable[[], int],
        post: Callable[[Callable[[], None]], None],
        end: Callable[[GoalState], None],
    ) -> None:
        self._handle, self._feedback, self._server = handle, feedback, server
        self._now, self._post, self._end = now, post, end
        self._name = bytes(handle.goal_id.uuid).hex()
        self._targets: tuple[StampedPose, ...] = ()
        self._id = self._name
        self._began = now()
        self._cancelled = self._ended = False

    def begin(self) -> None:
        """Send the first pose."""
        try:
            self._targets = targets_of(self._handle.request)
        except ValueError as problem:
            self.finish(GoalState(self._name, "aborted", str(problem)))
        else:
            self._send()

    def cancel(self) -> None:
        """Cancel the goal."""
        self._cancelled = True
        self._server.cancel_goal(self._id)

    def report_state(self, state: GoalState) -> None:
        if state.open:
            return
        if state.state != "succeeded" or len(self._targets) == 1:
            self.finish(state)
            return
        self._targets = self._targets[1:]
        self._id = f"{self._name}-{len(self._targets)}"
        self._post(self._send)  # the node is still at the end of the one before

    def report_pose(self, pose: StampedPose) -> None:
        if not self._ended:
            there, here = self._targets[0].pose, pose.pose
            seconds = (self._now() - self._began) / 1e9
            distance = math.hypot(there.x - here.x, there.y - here.y)
            fill_feedback(self._feedback, pose, seconds, distance, len(self._targets))
            self._handle.publish_feedback(self._feedback)

    def _send(self) -> None:
        if self._cancelled:
            self.finish(GoalState(self._id, "cancelled", "cancelled"))
        else:
            self._server.handle_goal(Goal(self._id, self._targets[0]), self)

    def finish(self, state: GoalState) -> None:
        """End the goal, once."""
        if not self._ended:
            self._ended = True
            self._end(state)


class NavigationActions:
    """Offers both actions. `post` makes calls on the node's thread; rclpy's are made on the executor's."""

    def __init__(
        self,
        node: Node,
        executor: SingleThreadedExecutor,
        post: Callable[[Callable[[], None]], None],
        now: Callable[[], int],
    ) -> None:
        self._node, self._executor, self._post, self._now = node, executor, post, now
        self._group = ReentrantCallbackGroup()
        self._servers: list[ActionServer] = []
        self._pursuits: dict[bytes, Pursuit] = {}

    def serve(self, name: str, server: TopicGoalServer, kept: float) -> None:
        """Offer the action of that full name, and beside `navigate_to_pose` the one through poses."""
        self._offer("NavigateToPose", name, server, kept)
        if name.endswith(f"/{TO_POSE}"):
            self._offer("NavigateThroughPoses", name.removesuffix(TO_POSE) + THROUGH_POSES, server, kept)

    def end(self) -> None:
        """End the open goals, as the node ends."""
        for each in list(self._pursuits.values()):
            each.finish(GoalState("", "aborted", f"{self._node.get_name()} ends"))

    def close(self) -> None:
        """Stop offering the actions, after the executor has ended."""
        while self._servers:
            self._servers.pop().destroy()

    def _offer(self, type_name: str, name: str, server: TopicGoalServer, kept: float) -> None:
        action = find_action(type_name)
        if action is None:
            return

        async def pursue(handle: ServerGoalHandle) -> NavigateToPose.Result:
            return await self._pursue(handle, action, server)

        self._servers.append(
            ActionServer(
                self._node,
                action,
                name,
                pursue,
                callback_group=self._group,
                goal_callback=lambda _goal: GoalResponse.ACCEPT,
                cancel_callback=self._cancel,
                result_timeout=math.ceil(max(kept, _KEPT)),
            )
        )

    async def _pursue(
        self, handle: ServerGoalHandle, action: type[NavigateToPose], server: TopicGoalServer
    ) -> NavigateToPose.Result:
        done = rclpy.Future(executor=self._executor)
        key = bytes(handle.goal_id.uuid)

        def end(state: GoalState) -> None:
            done.set_result(state)
            self._executor.wake()

        pursuit = Pursuit(handle, action.Feedback(), server, self._now, self._post, end)
        self._pursuits[key] = pursuit
        self._post(pursuit.begin)
        state: GoalState = await done
        del self._pursuits[key]
        result = action.Result()
        if state.state == "succeeded":
            handle.succeed()
        elif state.state == "cancelled" and handle.is_cancel_requested:
            handle.canceled()
        else:
            fill_result(result, state.text or "no reason was given")
            handle.abort()
        return result

    def _cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        pursuit = self._pursuits.get(bytes(handle.goal_id.uuid))
        if pursuit is None:
            return CancelResponse.REJECT
        self._post(pursuit.cancel)  # the goal is marked as cancelled before the executor learns that it has ended
        return CancelResponse.ACCEPT
