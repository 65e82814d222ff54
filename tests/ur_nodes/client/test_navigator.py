"""The client of navigation for another thread, on a bus."""

from ur_nodes.client.navigation import Names
from ur_nodes.client.navigator import RobotNavigator
from ur_nodes.client.snapshot import LastGoalState
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.actions import Goal
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedPose


def test_goal_on_its_way_is_not_taken_for_another_that_is_heard_of_meanwhile() -> None:
    bus = Bus()
    navigator = RobotNavigator(bus.node("script"), Names(), "script")
    current = bus.node("move_base").publish("move_base/current_goal", StampedPose, Quality.LATCHED)
    sent: list[Goal] = []
    bus.node("server").subscribe("move_base/goal", Goal, sent.append, Quality.EVERY)
    current.send(StampedPose(bus.now, "map", Pose2(5.0, 6.0, 0.0)))  # of a client before
    number = navigator.go(Pose2(1.0, 2.0, 0.0))
    assert bus.run_until(lambda: navigator.topics.goal().number == number, 1.0)
    assert not sent
    shown = navigator.snapshot().goal
    assert (shown.number, shown.state, shown.pose) == (number, LastGoalState.WAITING, Pose2(1.0, 2.0, 0.0))
    assert bus.run_until(lambda: bool(sent), 1.0)
    shown = navigator.snapshot().goal
    assert (shown.number, shown.state, shown.pose) == (number, LastGoalState.WAITING, Pose2(1.0, 2.0, 0.0))
