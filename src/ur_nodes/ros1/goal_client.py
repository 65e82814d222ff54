"""The client's end of the action move_base_msgs/MoveBaseAction: its topics, which also carry the goals of others."""

from __future__ import annotations

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult

from ur_nodes.codecs.places import fill_placed
from ur_nodes.loop import Loop
from ur_nodes.ports.actions import Goal, GoalFollower, GoalPhase, GoalState
from ur_nodes.ros1.ending import quiet_at_end

_STATES: dict[int, GoalPhase] = {
    GoalStatus.PENDING: "pending",
    GoalStatus.RECALLING: "pending",
    GoalStatus.ACTIVE: "active",
    GoalStatus.PREEMPTING: "active",
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.PREEMPTED: "cancelled",
    GoalStatus.RECALLED: "cancelled",
}  # anything else was given up


class RosGoalClient:
    """See `ports.actions.GoalClient`."""

    def __init__(self, action: str, follower: GoalFollower, loop: Loop) -> None:
        self._goals = rospy.Publisher(f"{action}/goal", MoveBaseActionGoal, queue_size=5)
        self._cancels = rospy.Publisher(f"{action}/cancel", GoalID, queue_size=5)

        def take_states(message: GoalStatusArray) -> None:
            follower.take_states(tuple(map(state_of, message.status_list)))

        def take_end(message: MoveBaseActionResult) -> None:
            follower.take_goal_end(state_of(message.status))

        rospy.Subscriber(f"{action}/status", GoalStatusArray, loop.mailbox(1, take_states), queue_size=1)
        rospy.Subscriber(f"{action}/result", MoveBaseActionResult, loop.mailbox(100, take_end), queue_size=10)

    @quiet_at_end
    def send(self, goal: Goal) -> None:
        message = MoveBaseActionGoal()
        message.header.stamp = message.goal_id.stamp = rospy.Time.now()
        message.goal_id.id = goal.id
        fill_placed(message.goal.target_pose, goal.target)
        self._goals.publish(message)

    @quiet_at_end
    def cancel(self, id: str = "") -> None:
        self._cancels.publish(GoalID(id=id))  # an empty one cancels all: actionlib's protocol

    def servers(self) -> int:
        return min(int(self._goals.get_num_connections()), int(self._cancels.get_num_connections()))


def state_of(status: GoalStatus) -> GoalState:
    """The state in an actionlib_msgs/GoalStatus."""
    return GoalState(str(status.goal_id.id), _STATES.get(status.status, "aborted"), str(status.text))
