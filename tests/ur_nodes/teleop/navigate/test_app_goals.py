"""Goals on the navigation screen: sent, shown, ended."""

import math
from typing import Any

import pytest
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen
from tests.ur_nodes.teleop.recordings import no_recordings

from ur_nodes.client.snapshot import LastGoalState, RobotSnapshot
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.navigate.app import NavigateApp


async def test_goal_command_sends_a_goal_and_says_so(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    assert navigator.goals == [Pose2(2.0, 3.0, math.pi / 2)]
    assert "driving to 2.00 3.00 90" in screen.text("message")
    assert "driving" in screen.text("status")
    assert "3.6 m left" in screen.text("status")
    assert not navigator.any_heading


async def test_goal_command_without_an_angle_shows_none(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 100 100")
    assert navigator.any_heading
    assert screen.text("message").strip() == "driving to 100.00 100.00"


async def test_reaching_and_failing_are_announced(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    navigator.move(Pose2(2.0, 2.95, 1.5))
    navigator.end(LastGoalState.REACHED)
    await screen.refresh()
    assert "reached 2.00 3.00 90, 0.05 m off" in screen.text("message")
    await screen.type("g 0 5")
    navigator.end(LastGoalState.FAILED, "the goal is in a wall")
    await screen.refresh()
    assert "failed: the goal is in a wall" in screen.text("message")


async def test_stop_pose_and_search_reach_the_robot(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 1 1")
    await screen.type("s")
    assert navigator.stops == 1
    await screen.type("i 1 2 90")
    assert navigator.poses == [Pose2(1.0, 2.0, math.pi / 2)]
    await screen.type("global")
    assert navigator.searches == 1
    navigator.offers_search = False
    await screen.type("global")
    assert "/global_localization" in screen.text("message")


async def test_result_of_a_goal_leaves_with_its_message(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 1 1")
    navigator.end(LastGoalState.FAILED, "in a wall")
    await screen.refresh()
    assert "failed" in screen.text("status")
    assert "in a wall" in screen.text("message")
    await screen.type("i 1 2 90")
    await screen.refresh()
    assert "failed" not in screen.text("status")


async def test_waiting_names_what_is_missing_and_goals_are_not_sent(screen: AppScreen, navigator: Any) -> None:
    navigator.seen = RobotSnapshot(missing=("the map (topic /map)", "navigation (action /move_base)"))
    await screen.refresh()
    assert "waiting for the map (topic /map) and navigation (action /move_base)" in screen.text("status")
    await screen.pilot.click(MapView, offset=(50, 10))
    assert not navigator.goals
    assert "not sent" in screen.text("message")


@pytest.mark.parametrize(("keys", "sent"), [([], True), (["s", "enter"], False), (["space"], False)])
async def test_goal_typed_before_the_robot_is_ready_waits_and_a_stop_drops_it(
    navigator: Any, store: WaypointStore, keys: list[str], sent: bool
) -> None:
    ready = navigator.seen
    navigator.seen = RobotSnapshot(missing=("the map (topic /map)",))
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings(), typed="g 1 ")
    async with app.run_test(size=(100, 36)) as pilot:
        screen = AppScreen(app, pilot)
        await pilot.press("2", "ctrl+j")  # Enter, as the terminal passes it on from before the screen opened
        await screen.refresh()
        assert "'g 1 2' is sent when the robot is ready" in screen.text("message")
        assert not navigator.goals
        await pilot.press(*keys)
        navigator.seen = ready
        await screen.refresh()
        assert [(goal.x, goal.y) for goal in navigator.goals] == ([(1.0, 2.0)] if sent else [])


async def test_own_goal_is_cancelled_at_the_end_and_another_is_not(screen: AppScreen, navigator: Any) -> None:
    navigator.go(Pose2(1.0, 1.0, 0.0))
    screen.app.cancel_own_goal()
    assert navigator.stops == 0
    await screen.type("g 1 1")
    screen.app.cancel_own_goal()
    assert navigator.stops == 1
