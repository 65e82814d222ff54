"""Commands, the emergency stop, the command line and the end of the navigation screen."""

from dataclasses import replace
from typing import Any

import pytest
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen
from tests.ur_nodes.teleop.recordings import no_recordings

from ur_nodes.client.mux import MuxView
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.teleop.navigate.app import NavigateApp
from ur_nodes.teleop.navigate.command_line import CommandLine


async def test_space_stops_everything_and_only_a_release_lets_goals_be_sent(screen: AppScreen, navigator: Any) -> None:
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
async def test_space_stops_wherever_the_focus_is(screen: AppScreen, navigator: Any, keys: list[str]) -> None:
    await screen.pilot.press(*keys)
    assert navigator.asked == ["stop"]


async def test_emergency_of_somebody_else_and_a_stop_that_failed_are_shown(screen: AppScreen, navigator: Any) -> None:
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
async def test_error_is_one_clear_line(screen: AppScreen, navigator: Any, line: str, message: str) -> None:
    await screen.type(line)
    assert message in screen.text("message")
    assert not navigator.goals


async def test_help_opens_at_once_and_any_key_closes_it(screen: AppScreen) -> None:
    await screen.pilot.press("question_mark")
    assert screen.panel.is_open
    assert "emergency stop for every client" in screen.panel_text()
    await screen.pilot.press("space")
    assert not screen.panel.is_open


@pytest.mark.parametrize("again", ["q", "ctrl+c"])
async def test_end_that_ends_the_robot_of_others_is_asked_for_once(
    navigator: Any, store: WaypointStore, again: str
) -> None:
    users = ["m_wander.5767", "a page"]
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings(), list_users=lambda: users)
    async with app.run_test(size=(100, 36)) as pilot:
        screen = AppScreen(app, pilot)
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


async def test_end_without_other_users_is_not_asked_for(screen: AppScreen) -> None:
    await screen.pilot.press("ctrl+c")
    await screen.pilot.pause()
    assert not screen.app.is_running


async def test_other_letter_after_tab_begins_a_command(screen: AppScreen, navigator: Any) -> None:
    await screen.pilot.press("tab")
    await screen.pilot.press("g", "space", "1", "space", "2", "enter")
    assert navigator.goals[0][:2] == (1.0, 2.0)


async def test_second_tab_gives_letters_back_to_the_command_line(screen: AppScreen) -> None:
    whole = screen.app.map.view
    await screen.pilot.press("tab", "tab", "l")
    assert screen.app.query_one(CommandLine).value == "l"
    assert screen.app.map.view == whole


async def test_words_that_begin_with_a_key_of_the_map_are_typed_whole(screen: AppScreen, navigator: Any) -> None:
    await screen.pilot.press(*"take", "enter")
    assert navigator.requests == ["take"]


async def test_history_brings_lines_back(screen: AppScreen) -> None:
    await screen.type("g 1 1")
    await screen.type("s")
    line = screen.app.query_one(CommandLine)
    await screen.pilot.press("up", "up")
    assert line.value == "g 1 1"
    await screen.pilot.press("down", "down")
    assert line.value == ""


@pytest.mark.parametrize("keys", [["q", "enter"], ["ctrl+c"], ["ctrl+q"]])
async def test_quit_ends_the_program(navigator: Any, store: WaypointStore, keys: list[str]) -> None:
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings())
    async with app.run_test() as pilot:
        await pilot.press(*keys)
    assert not app.is_running
