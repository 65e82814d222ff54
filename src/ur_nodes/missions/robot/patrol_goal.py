"""The last goal of a patrol, and its state."""

import itertools

from ur_nodes.client.goal_tracker import GoalTracker, is_unconfirmed, report_at, track_result, track_sent, track_status
from ur_nodes.client.patrol_text import PatrolStop
from ur_nodes.client.snapshot import GoalReport, LastGoalState, heading_there
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.ports import actions
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import StampedPose


class PatrolGoal:
    """Sends goals, one at a time. Goals of an earlier node of this name are cancelled."""

    def __init__(self, node: Node, navigation: str, frames: tuple[str, str], client: LeaseClient) -> None:
        """`frames` are those of the map and of the base; `client` is the sender that the goals name."""
        self._node, self._client = node, client
        self._map_frame, self._base_frame = frames
        self._transforms = node.transforms
        self._tracker = GoalTracker()
        self._goal = ""
        self._numbers = itertools.count(1)
        self._prefix = f"{node.name}-patrol-"
        self._goals = node.follow_goals(navigation, self)

    @property
    def report(self) -> GoalReport | None:
        """Return the state of the goal; None without a goal, or before navigation has reported it."""
        report = report_at(self._tracker, self._node.steady())
        mentioned = self._goal and (self._tracker.known or report.state is LastGoalState.FAILED)
        return report if mentioned else None

    @property
    def ready(self) -> bool:
        """Return whether a goal can be sent now."""
        answers = self._client.view().state == "unknown" or self._answer() is not None
        return answers and self._goals.servers() > 0

    def send(self, stop: PatrolStop) -> None:
        """Drive to a stop whose place is known."""
        assert stop.x is not None, "looked up before the start"
        start = f"{self._prefix}{next(self._numbers)}-{self._node.now()}"
        start = write_any_heading(start) if stop.yaw is None else start
        answer = self._answer()
        claimed = answer is not None and self._client.view().state != "unknown"
        self._goal = write_goal_id(start, self._client.client, answer) if claimed and answer is not None else start
        yaw = stop.yaw
        if yaw is None:
            yaw = heading_there(self._transforms.find_planar(self._map_frame, self._base_frame), stop.x, stop.y)
        place = Pose2(stop.x, stop.y, yaw)
        self._tracker = track_sent(self._tracker, self._goal, place, self._node.steady())
        self._sent = actions.Goal(self._goal, StampedPose(self._node.now(), self._map_frame, place))
        self._goals.send(self._sent)

    def cancel(self) -> None:
        """Cancel the goal."""
        if self._goal:
            self._goals.cancel(self._goal)
            self._goal = ""

    def on_states(self, states: tuple[actions.GoalState, ...]) -> None:
        if self._goal:
            now = self._node.steady()
            self._tracker = track_status(self._tracker, states, now)
            if is_unconfirmed(self._tracker, now):
                self._goals.send(self._sent)
        for each in states:  # of a node of this name that was killed
            if each.open and each.id.startswith(self._prefix) and each.id != self._goal:
                self._goals.cancel(each.id)

    def on_goal_end(self, state: actions.GoalState) -> None:
        if self._goal:
            self._tracker = track_result(self._tracker, state, self._node.steady())

    def _answer(self) -> int | None:
        return self._client.link.newest(REQUEST_FRESHNESS / 2.0)
