"""Goals as upstream's navigation takes them: the action move_base_msgs/MoveBaseAction, and ACTION_simple/goal."""

from collections.abc import Callable

import rospy
from actionlib import ActionServer, ServerGoalHandle
from actionlib.goal_id_generator import GoalIDGenerator
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import (
    MoveBaseAction,
    MoveBaseActionGoal,
    MoveBaseActionResult,
    MoveBaseFeedback,
    MoveBaseResult,
)

from ur_nodes.codecs.poses import fill_stamped, stamped_of
from ur_nodes.loop import Loop
from ur_nodes.ports.actions import Goal, GoalFollower, GoalHandlers, GoalPhase, GoalState
from ur_nodes.ports.values import StampedPose
from ur_nodes.ros1.ending import quiet_at_end
from ur_nodes.ros1.topics import header_of

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

        self._servers = set[str]()

        def on_states(message: GoalStatusArray) -> None:
            self._servers.add(header_of(message).get("callerid", ""))
            follower.on_states(tuple(map(state_of, message.status_list)))

        def on_result(message: MoveBaseActionResult) -> None:
            follower.on_goal_end(state_of(message.status))

        rospy.Subscriber(f"{action}/status", GoalStatusArray, loop.mailbox(1, on_states), queue_size=1)
        rospy.Subscriber(f"{action}/result", MoveBaseActionResult, loop.mailbox(100, on_result), queue_size=10)

    @quiet_at_end
    def send(self, goal: Goal) -> None:
        message = MoveBaseActionGoal()
        message.header.stamp = message.goal_id.stamp = rospy.Time.now()
        message.goal_id.id = goal.id
        fill_stamped(message.goal.target_pose, goal.target)
        self._goals.publish(message)

    @quiet_at_end
    def cancel(self, id: str = "") -> None:
        self._cancels.publish(GoalID(id=id))  # an empty one cancels all: actionlib's protocol

    def servers(self) -> int:
        """Return whether a node that tells how goals are listens to both topics: recorders listen, too."""
        goals, cancels = self._goals.impl, self._cancels.impl
        return int(any(goals.has_connection(each) and cancels.has_connection(each) for each in self._servers))


def state_of(status: GoalStatus) -> GoalState:
    """The state in an actionlib_msgs/GoalStatus."""
    return GoalState(str(status.goal_id.id), _STATES.get(status.status, "aborted"), str(status.text))


class RosGoalServer:
    """See `ports.actions.GoalServer`. The server's own lock is never held while the node runs."""

    def __init__(self, action: str, handlers: GoalHandlers, loop: Loop, kept: float) -> None:
        self._handlers = handlers
        self._handles: dict[str, RosGoalHandle] = {}  # of goals that have not ended
        handle_goal = loop.mailbox(100, self._on_goal)
        handle_cancel = loop.mailbox(100, self._on_cancel)
        self._server = ActionServer(action, MoveBaseAction, handle_goal, handle_cancel, auto_start=False)
        self._server.publish_status = quiet_at_end(self._server.publish_status)  # a thread of its own calls it
        self._goals = rospy.Publisher(f"{action}/goal", MoveBaseActionGoal, queue_size=10)
        self._ids = GoalIDGenerator()
        rospy.Subscriber(f"{action}_simple/goal", PoseStamped, self._pass_on, queue_size=100)
        self._server.start()
        self._server.status_list_timeout = rospy.Duration.from_sec(kept)

    def publish_status(self) -> None:
        self._server.publish_status()

    def _pass_on(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.goal_id.id = self._ids.generate_ID().id
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._goals.publish(goal)  # for those who listen to goals; this server may not be connected to itself yet
        self._server.internal_goal_callback(goal)  # a second one with this id is ignored

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        own = RosGoalHandle(handle, self._handles.pop)
        self._handles[own.goal.id] = own
        self._handlers.handle_goal(own)

    def _on_cancel(self, handle: ServerGoalHandle) -> None:
        own = self._handles.get(handle.get_goal_id().id)
        if own is not None:
            self._handlers.handle_cancel(own)


class RosGoalHandle:
    """See `ports.actions.GoalHandle`. The server keeps a goal's state for a while from when its handle is dropped."""

    def __init__(self, handle: ServerGoalHandle, drop: Callable[[str], object]) -> None:
        self._handle: ServerGoalHandle | None = handle
        self._drop = drop
        self.goal = Goal(handle.get_goal_id().id, stamped_of(handle.get_goal().target_pose))

    def accept(self) -> None:
        self._open.set_accepted()

    def refuse(self, text: str) -> None:
        self._open.set_accepted()
        self.abort(text)

    def note(self, text: str) -> None:
        self._open.status_tracker.status.text = text

    def report(self, pose: StampedPose) -> None:
        message = PoseStamped()
        fill_stamped(message, pose)
        self._open.publish_feedback(MoveBaseFeedback(base_position=message))

    def succeed(self, text: str) -> None:
        self._end().set_succeeded(MoveBaseResult(), text)

    def abort(self, text: str) -> None:
        self._end().set_aborted(MoveBaseResult(), text)

    def cancel(self, text: str) -> None:
        self._end().set_canceled(MoveBaseResult(), text)

    def _end(self) -> ServerGoalHandle:
        handle, self._handle = self._open, None
        self._drop(self.goal.id)
        return handle

    @property
    def _open(self) -> ServerGoalHandle:
        assert self._handle is not None, "the goal has not ended"
        return self._handle
