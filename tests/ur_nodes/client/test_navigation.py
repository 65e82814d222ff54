"""The topics of navigation on a bus: goals of this client and of others, and paths that arrive late."""

import numpy as np
import pytest

from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.client.snapshot import LastGoalState
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.actions import Goal, GoalState, GoalStates
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Path, PoseEstimate

THERE, ELSEWHERE = Pose2(1.0, 0.0, 0.0), Pose2(3.0, 1.0, 0.5)


class Navigation:
    """A client, and a robot that says of goals what a test wants."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.client = NavigationTopics(self.bus.node("client"), Names())
        robot = self.bus.node("robot")
        self._states = robot.publish("move_base/state", GoalState, Quality.EVERY)
        self._status = robot.publish("move_base/status", GoalStates)
        self._plan = robot.publish("move_base/NavfnROS/plan", Path)
        self._pose = robot.publish("amcl_pose", PoseEstimate, Quality.LATCHED)
        self.received: list[str] = []
        robot.subscribe("move_base/goal", Goal, lambda goal: self.received.append(goal.id), Quality.EVERY)
        self.bus.run(0.1)

    def list_goals(self, *states: GoalState) -> None:
        self._status.send(GoalStates(states))
        self.bus.run(0.1)

    def end_goal(self, state: GoalState) -> None:
        self._states.send(state)
        self.bus.run(0.1)

    def plan(self, *poses: Pose2) -> None:
        self._plan.send(Path(self.bus.now, "map", np.array(poses)))
        self.bus.run(0.1)

    def localise(self, deviation: float) -> None:
        self._pose.send(PoseEstimate(self.bus.now, "map", THERE, np.diag((deviation**2, 0.0, 0.0))))
        self.bus.run(0.1)


def test_goal_that_is_reached_says_how_far_off_the_robot_may_be() -> None:
    navigation = Navigation()
    for deviation, text in ((0.1, ""), (0.5, "up to 1.0 m off, the map shows no place nearer")):
        navigation.client.send_goal(f"ours {deviation}", THERE)
        navigation.list_goals(GoalState(f"ours {deviation}", "active", ""))
        navigation.localise(deviation)
        navigation.end_goal(GoalState(f"ours {deviation}", "succeeded", "goal reached"))
        assert navigation.client.goal().text == text
        navigation.localise(2.0)
        assert navigation.client.goal().text == text, "that was not known then"


def test_path_that_arrives_after_the_goal_was_reached_is_no_goal_of_another() -> None:
    navigation = Navigation()
    number = navigation.client.send_goal("ours", THERE)
    navigation.list_goals(GoalState("ours", "active", ""))
    navigation.end_goal(GoalState("ours", "succeeded", ""))
    navigation.plan(Pose2(1.003, 0.001, 0.0))
    report = navigation.client.goal()
    assert (report.number, report.state, report.pose) == (number, LastGoalState.REACHED, THERE)


def test_goal_of_another_client_is_where_the_path_ends() -> None:
    navigation = Navigation()
    number = navigation.client.send_goal("ours", THERE)
    navigation.end_goal(GoalState("ours", "succeeded", ""))
    listed = (GoalState("ours", "succeeded", ""), GoalState("theirs", "active", ""))
    navigation.list_goals(*listed)
    navigation.plan(THERE, ELSEWHERE)
    navigation.list_goals(*listed)
    report = navigation.client.goal()
    assert (report.number, report.state, report.pose) == (number + 1, LastGoalState.DRIVING, ELSEWHERE)


def test_goal_is_sent_again_until_navigation_lists_it() -> None:
    navigation = Navigation()
    navigation.client.send_goal("ours", THERE)
    navigation.list_goals()  # the goal was lost, or is on its way
    assert navigation.received == ["ours", "ours"]
    navigation.list_goals(GoalState("ours", "active", ""))
    navigation.list_goals()
    assert navigation.received == ["ours", "ours"]


@pytest.mark.parametrize("is_cancelled", [True, False])
def test_goal_that_was_cancelled_or_sent_long_ago_is_not_sent_again(*, is_cancelled: bool) -> None:
    navigation = Navigation()
    navigation.client.send_goal("ours", THERE)
    if is_cancelled:
        navigation.client.cancel_goals()
    else:
        navigation.bus.run(1.1)
    navigation.list_goals()
    assert navigation.received == ["ours"]
