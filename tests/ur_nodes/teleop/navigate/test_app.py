from __future__ import annotations

import math
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import pytest_asyncio
from textual.pilot import Pilot
from textual.widgets import Static

from ur_nodes.client.model import GoalState, Snapshot
from ur_nodes.client.mux import MuxView
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import LIGHT, LIGHT_16
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.navigate.app import NavigateApp
from ur_nodes.teleop.navigate.command_line import CommandLine
from ur_nodes.teleop.navigate.panel import Panel
from ur_nodes.teleop.navigator.map_saving_node import MapSaving


class Screen:
    """The running app as a user has it before them."""

    def __init__(self, app: NavigateApp, pilot: Pilot[None]) -> None:
        self.app = app
        self.pilot = pilot

    async def type(self, line: str) -> None:
        self.app.query_one(CommandLine).value = line
        await self.pilot.press("enter")
        await self.refresh()

    async def refresh(self) -> None:
        self.app._look()
        await self.pilot.pause()

    @property
    def panel(self) -> Panel:
        return self.app.query_one(Panel)

    def panel_text(self) -> str:
        return "\n".join(
            "".join(segment.text for segment in line)
            for line in self.app.console.render_lines(self.panel.query_one(Static).content)  # type: ignore[arg-type]
        )

    def text(self, id: str) -> str:
        return str(self.app.query_one(f"#{id}", Static).render())


@pytest_asyncio.fixture
async def screen(navigator: Any, store: WaypointStore) -> AsyncIterator[Screen]:
    app = NavigateApp(navigator, lambda _: store, title="maze")
    async with app.run_test(size=(100, 36)) as pilot:
        await pilot.pause()
        yield Screen(app, pilot)


async def test_goal_command_sends_a_goal_and_says_so(screen: Screen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    assert navigator.goals == [Pose2(2.0, 3.0, math.pi / 2)]
    assert "driving to 2.00 3.00 90" in screen.text("message")
    assert "driving" in screen.text("status")
    assert "3.6 m left" in screen.text("status")
    assert not navigator.any_heading


async def test_goal_command_without_an_angle_shows_none(screen: Screen, navigator: Any) -> None:
    await screen.type("g 100 100")
    assert navigator.any_heading
    assert screen.text("message").strip() == "driving to 100.00 100.00"


async def test_reaching_and_failing_are_announced(screen: Screen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    navigator.move(Pose2(2.0, 2.95, 1.5))
    navigator.end(GoalState.REACHED)
    await screen.refresh()
    assert "reached 2.00 3.00 90, 0.05 m off" in screen.text("message")
    await screen.type("g 0 5")
    navigator.end(GoalState.FAILED, "the goal is in a wall")
    await screen.refresh()
    assert "failed: the goal is in a wall" in screen.text("message")


async def test_space_stops_everything_and_only_a_release_lets_goals_be_sent(screen: Screen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    await screen.pilot.press("space")
    await screen.refresh()
    assert navigator.asked == ["stop"]
    assert navigator.stops == 1
    assert "EMERGENCY STOP: r and Enter" in screen.text("status")
    await screen.type("g 1 1")
    assert len(navigator.goals) == 1
    assert "not sent: the emergency stop is on" in screen.text("message")
    await screen.type("r")
    assert navigator.asked == ["stop", "release"]
    assert "EMERGENCY" not in screen.text("status")
    await screen.type("g 1 1")
    assert len(navigator.goals) == 2


@pytest.mark.parametrize(
    "keys",
    [["space"], ["g", "space", "1", "space", "space"], ["tab", "space"], ["question_mark", "space"]],
    ids=["empty line", "twice while typing", "map", "help"],
)
async def test_space_stops_wherever_the_focus_is(screen: Screen, navigator: Any, keys: list[str]) -> None:
    await screen.pilot.press(*keys)
    assert navigator.asked == ["stop"]


async def test_emergency_of_somebody_else_and_a_stop_that_failed_are_shown(screen: Screen, navigator: Any) -> None:
    navigator.seen = replace(navigator.seen, mux=MuxView(stopped=True))
    await screen.refresh()
    assert "EMERGENCY STOP" in screen.text("status")
    navigator.seen = replace(navigator.seen, mux=MuxView(problem="NOT STOPPED: no answer"))
    await screen.refresh()
    assert "NOT STOPPED: no answer" in screen.text("status")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("g 2 x", "'x' is not a number, expected: g X Y [ANGLE]"),
        ("fly", "unknown command 'fly', expected g X Y"),
        ("foo", "unknown command 'foo', expected g X Y"),
        ("take off", "unexpected 'off', expected: drive"),
        ("m nowhere", "unknown waypoint 'nowhere'"),
    ],
)
async def test_error_is_one_clear_line(screen: Screen, navigator: Any, line: str, message: str) -> None:
    await screen.type(line)
    assert message in screen.text("message")
    assert not navigator.goals


async def test_waypoint_is_remembered_listed_and_driven_to(screen: Screen, navigator: Any) -> None:
    navigator.move(Pose2(1.0, 2.0, 0.0))
    await screen.type("w kitchen")
    assert "waypoint 'kitchen' saved at 1.00 2.00 0" in screen.text("message")
    await screen.type("l")
    assert screen.panel.is_open
    assert "kitchen  1.00 2.00 0" in screen.panel_text()
    await screen.pilot.press("x")
    await screen.type("m kitchen")
    assert navigator.goals == [Pose2(1.0, 2.0, 0.0)]


async def test_help_opens_at_once_and_any_key_closes_it(screen: Screen) -> None:
    await screen.pilot.press("question_mark")
    assert screen.panel.is_open
    assert "emergency stop, whoever drives" in screen.panel_text()
    await screen.pilot.press("space")
    assert not screen.panel.is_open


async def test_stop_pose_and_search_reach_the_robot(screen: Screen, navigator: Any) -> None:
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


async def test_click_sets_a_goal_there_for_which_any_heading_counts(screen: Screen, navigator: Any) -> None:
    view = screen.app.map.view
    await screen.pilot.click(MapView, offset=(70, 10))
    expected = view.to_map(70.5, 21.0)
    (goal,) = navigator.goals
    assert goal == pytest.approx((*expected, math.atan2(expected[1], expected[0])))  # for upstream's move_base
    assert navigator.any_heading


async def test_drag_sets_the_heading(screen: Screen, navigator: Any) -> None:
    view = screen.app.map.view
    await screen.pilot.mouse_down(MapView, offset=(50, 20))
    await screen.pilot.hover(MapView, offset=(50, 15))
    await screen.pilot.mouse_up(MapView, offset=(50, 15))
    (goal,) = navigator.goals
    assert goal == pytest.approx((*view.to_map(50.5, 41.0), math.pi / 2))
    assert not navigator.any_heading


def signs(screen: Screen) -> str:
    return "".join(text for line in screen.app.map._lines for text, _, _ in line if text in "◎→↗↑↖←↙↓↘")


async def test_arrow_is_shown_only_once_a_drag_is_long_enough(screen: Screen, navigator: Any) -> None:
    await screen.pilot.mouse_down(MapView, offset=(70, 10))
    await screen.pilot.hover(MapView, offset=(71, 10))
    assert "◎" in signs(screen)
    await screen.pilot.hover(MapView, offset=(72, 10))
    assert "◎" not in signs(screen)
    await screen.pilot.hover(MapView, offset=(71, 10))
    await screen.pilot.mouse_up(MapView, offset=(71, 10))
    assert len(navigator.goals) == 1
    assert navigator.any_heading


async def test_result_of_a_goal_leaves_with_its_message(screen: Screen, navigator: Any) -> None:
    await screen.type("g 1 1")
    navigator.end(GoalState.FAILED, "in a wall")
    await screen.refresh()
    assert "failed" in screen.text("status")
    assert "in a wall" in screen.text("message")
    await screen.type("i 1 2 90")
    await screen.refresh()
    assert "failed" not in screen.text("status")


@pytest.mark.parametrize("again", ["q", "ctrl+c"])
async def test_end_that_ends_the_robot_of_others_is_asked_for_once(
    navigator: Any, store: WaypointStore, again: str
) -> None:
    users = ["m_wander.5767", "a page"]
    app = NavigateApp(navigator, lambda _: store, list_users=lambda: users)
    async with app.run_test(size=(100, 36)) as pilot:
        screen = Screen(app, pilot)
        for ask in ("ctrl+c", "q"):
            await pilot.press(ask, "enter") if ask == "q" else await pilot.press(ask)
            assert "m_wander.5767 and a page use this robot; it ends with this program." in screen.text("message")
            await pilot.press("x")
            assert app.is_running
            assert not screen.text("message")
            assert not app.query_one(CommandLine).value
        await pilot.press("ctrl+c", "space")
        assert navigator.asked == ["stop"]  # the emergency key is one there, too
        await pilot.press("ctrl+c", again)
        await pilot.pause()
        assert not app.is_running


async def test_end_without_other_users_is_not_asked_for(screen: Screen) -> None:
    await screen.pilot.press("ctrl+c")
    await screen.pilot.pause()
    assert not screen.app.is_running


async def test_right_button_drags_the_map(screen: Screen, navigator: Any) -> None:
    before = screen.app.map.view.to_map(50, 20)
    await screen.pilot.mouse_down(MapView, offset=(50, 10), button=3)
    await screen.pilot.hover(MapView, offset=(60, 10))
    await screen.pilot.mouse_up(MapView, offset=(60, 10))
    assert screen.app.map.view.to_map(60, 20) == pytest.approx(before)
    assert not navigator.goals


@pytest.mark.parametrize("focus_map", [False, True])
async def test_keys_move_the_map(screen: Screen, focus_map: bool) -> None:
    if focus_map:
        await screen.pilot.press("tab")
    whole = screen.app.map.view
    await screen.pilot.press("plus")
    assert screen.app.map.view.scale == pytest.approx(whole.scale / 1.25)
    await screen.pilot.press("right")
    assert screen.app.map.view.x > whole.x
    await screen.pilot.press("minus", "minus")
    assert screen.app.map.view.scale == pytest.approx(whole.scale * 1.25)
    await screen.pilot.press("0")
    assert screen.app.map.view == whole


async def test_vi_keys_move_the_map_after_tab(screen: Screen) -> None:
    await screen.pilot.press("tab")
    whole = screen.app.map.view
    await screen.pilot.press("l", "k")
    assert (screen.app.map.view.x > whole.x, screen.app.map.view.y > whole.y) == (True, True)
    await screen.pilot.press("h", "j")
    assert (screen.app.map.view.x, screen.app.map.view.y) == pytest.approx((whole.x, whole.y))


async def test_other_letter_after_tab_begins_a_command(screen: Screen, navigator: Any) -> None:
    await screen.pilot.press("tab")
    await screen.pilot.press("g", "space", "1", "space", "2", "enter")
    assert navigator.goals[0][:2] == (1.0, 2.0)


async def test_second_tab_gives_letters_back_to_the_command_line(screen: Screen) -> None:
    whole = screen.app.map.view
    await screen.pilot.press("tab", "tab", "l")
    assert screen.app.query_one(CommandLine).value == "l"
    assert screen.app.map.view == whole


async def test_words_that_begin_with_a_key_of_the_map_are_typed_whole(screen: Screen, navigator: Any) -> None:
    await screen.pilot.press(*"take", "enter")
    assert navigator.requests == ["take"]


async def test_history_brings_lines_back(screen: Screen) -> None:
    await screen.type("g 1 1")
    await screen.type("s")
    line = screen.app.query_one(CommandLine)
    await screen.pilot.press("up", "up")
    assert line.value == "g 1 1"
    await screen.pilot.press("down", "down")
    assert line.value == ""


async def test_following_keeps_the_robot_in_view(screen: Screen, navigator: Any) -> None:
    await screen.type("f")
    for x in (1.0, 2.0, 3.0, 4.0):
        navigator.move(Pose2(x, 0.0, 0.0))
        await screen.refresh()
        column, _ = screen.app.map.view.to_pixel(x, 0.0)
        assert 0.2 * 100 < column < 0.8 * 100
    assert "following the robot" in screen.text("head")


async def test_resize_shows_the_whole_map_again(screen: Screen, navigator: Any) -> None:
    await screen.pilot.resize_terminal(60, 20)
    await screen.pilot.pause()
    view = screen.app.map.view
    left, bottom, right, top = navigator.seen.grid.bounds
    assert view.width == 60
    assert view.to_pixel(left, bottom)[0] >= 0
    assert view.to_pixel(right, top)[0] <= 60


async def test_waiting_names_what_is_missing_and_goals_are_not_sent(screen: Screen, navigator: Any) -> None:
    navigator.seen = Snapshot(missing=("the map (topic /map)", "navigation (action /move_base)"))
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
    navigator.seen = Snapshot(missing=("the map (topic /map)",))
    app = NavigateApp(navigator, lambda _: store, typed="g 1 ")
    async with app.run_test(size=(100, 36)) as pilot:
        screen = Screen(app, pilot)
        await pilot.press("2", "ctrl+j")  # Enter, as the terminal passes it on from before the screen opened
        await screen.refresh()
        assert "'g 1 2' is sent when the robot is ready" in screen.text("message")
        assert not navigator.goals
        await pilot.press(*keys)
        navigator.seen = ready
        await screen.refresh()
        assert [(goal.x, goal.y) for goal in navigator.goals] == ([(1.0, 2.0)] if sent else [])


async def test_light_and_dark(screen: Screen) -> None:
    await screen.type("t")
    assert screen.app.theme == "textual-light"
    assert screen.app.map.palette in (LIGHT, LIGHT_16)


async def test_same_picture_is_not_drawn_again(screen: Screen, navigator: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[object] = []
    monkeypatch.setattr(screen.app.map, "redraw", lambda: drawn.append(None))
    navigator.seen = replace(navigator.seen)
    await screen.refresh()
    assert not drawn
    navigator.seen = replace(navigator.seen, scan=np.array([[1.0, 1.0]]))
    await screen.refresh()
    assert len(drawn) == 1


@pytest.mark.parametrize("keys", [["q", "enter"], ["ctrl+c"], ["ctrl+q"]])
async def test_quit_ends_the_program(navigator: Any, store: WaypointStore, keys: list[str]) -> None:
    app = NavigateApp(navigator, lambda _: store)
    async with app.run_test() as pilot:
        await pilot.press(*keys)
    assert not app.is_running


async def test_own_goal_is_cancelled_at_the_end_and_another_is_not(screen: Screen, navigator: Any) -> None:
    navigator.go(Pose2(1.0, 1.0, 0.0))
    screen.app.cancel_own_goal()
    assert navigator.stops == 0
    await screen.type("g 1 1")
    screen.app.cancel_own_goal()
    assert navigator.stops == 1


async def test_broken_waypoint_file_is_named(navigator: Any, store: WaypointStore) -> None:
    store.path.parent.mkdir(parents=True)
    store.path.write_text("a: [1, 2]\n")
    app = NavigateApp(navigator, lambda _: store)
    async with app.run_test(size=(160, 30)) as pilot:
        await pilot.pause()
        assert "expected a list of 3 numbers" in str(app.query_one("#message", Static).render())


async def test_map_that_is_made_is_saved_and_has_no_waypoints_before_it_has_a_name(navigator: Any) -> None:
    saving = MapSaving(lambda: "map 'flat' saved", hint="save: save the map")
    app = NavigateApp(navigator, lambda _: None, saving=saving)
    async with app.run_test(size=(100, 36)) as pilot:
        screen = Screen(app, pilot)
        await screen.type("w here")
        assert "the map has no name yet" in screen.text("message")
        await screen.type("save")
        for _ in range(200):
            if "saved" in screen.text("message"):
                break
            await screen.refresh()
        assert screen.text("message") == "map 'flat' saved"


async def test_nothing_is_saved_where_no_map_is_made(screen: Screen) -> None:
    await screen.type("save")
    assert "no map is being made" in screen.text("message")


async def test_patrol_is_started_by_a_command_and_shown_whoever_has_started_it(
    screen: Screen, navigator: Any, store: WaypointStore
) -> None:
    store.remember("sofa", Pose2(1.0, 2.0, 0.0))
    await screen.type("patrol sofa")
    await screen.refresh()
    assert [action for action, _ in navigator.patrols] == ["start"]
    assert screen.text("message") == "patrol: drives to sofa (1 of 1)"
    assert screen.text("driver") == "patrol: drives to sofa (1 of 1); patrol pause, patrol end"
    navigator.patrol_problem = "laptop drives since 14:02"
    await screen.type("patrol resume")
    await screen.refresh()
    assert screen.text("message") == "refused: laptop drives since 14:02"
