"""Keys and clicks in quick succession, small screens, and terminals with few colours."""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import pytest
import pytest_asyncio
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen, open_app
from tests.ur_nodes.teleop.recordings import no_recordings
from textual import events
from textual.pilot import Pilot
from textual.widgets import Static

from ur_nodes.client.mux import MuxView
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.navigate.app import NavigateApp
from ur_nodes.teleop.navigate.command_line import EMPTY_LINE_KEYS, CommandLine
from ur_nodes.teleop.navigate.panel import Panel

KEYS = sorted({*EMPTY_LINE_KEYS, *"abcdefghijklmnoprstuvwxyz", "enter", "escape", "tab", "backspace", "space", "up"})
SMALL = (40, 12)


@pytest_asyncio.fixture
async def small(navigator: Any, store: WaypointStore) -> AsyncIterator[AppScreen]:
    async with open_app(navigator, store, SMALL) as shown:
        yield shown


def press_at_once(app: NavigateApp, keys: list[str]) -> None:
    """Press keys as a terminal delivers those of one read: nothing happens between them."""
    for key in keys:
        character = {"space": " ", "enter": "\r", "question_mark": "?"}.get(key, key if len(key) == 1 else None)
        app.post_message(events.Key(key, character))


def screen_text(pilot: Pilot[None]) -> str:
    """All that is on the screen."""
    compositor = pilot.app.screen._compositor
    return "\n".join("".join(segment.text for segment in strip) for strip in compositor.render_strips())


@pytest.mark.parametrize("opened_by", ["question_mark", "l"])
@pytest.mark.parametrize("key", KEYS)
async def test_key_pressed_twice_at_once_closes_a_panel_and_the_program_goes_on(
    screen: AppScreen, opened_by: str, key: str
) -> None:
    press_at_once(screen.app, ["question_mark"] if opened_by == "question_mark" else ["l", "enter"])
    press_at_once(screen.app, [key, key])
    await screen.pilot.pause()
    assert not screen.panel.is_open
    assert screen.app.is_running


@pytest.mark.parametrize("key", [key for key in KEYS if key != "q"])
async def test_key_pressed_twice_at_once_does_no_harm_on_the_main_screen(screen: AppScreen, key: str) -> None:
    press_at_once(screen.app, [key, key, "escape"])
    await screen.pilot.pause()
    assert screen.app.is_running
    assert not screen.app.query_one(CommandLine).value


async def test_double_click_closes_a_panel_and_sends_no_goal(screen: AppScreen, navigator: Any) -> None:
    screen.app.map.double_click = 60.0
    await screen.pilot.press("question_mark")
    await screen.pilot.pause()
    await screen.pilot.click(Panel)
    await screen.pilot.click(MapView, offset=(50, 16))
    assert not screen.panel.is_open
    assert not navigator.goals


async def test_double_click_on_the_map_sends_one_goal(screen: AppScreen, navigator: Any) -> None:
    screen.app.map.double_click = 60.0
    await screen.pilot.click(MapView, offset=(50, 10), times=2)
    assert len(navigator.goals) == 1
    await screen.pilot.click(MapView, offset=(60, 12))
    assert len(navigator.goals) == 2


async def test_keys_typed_right_after_a_click_are_not_lost(screen: AppScreen, navigator: Any) -> None:
    await screen.pilot.mouse_down(MapView, offset=(70, 10))
    await screen.pilot.mouse_up(MapView, offset=(70, 10))
    press_at_once(screen.app, ["g", "space", "1", "space", "2", "enter"])
    await screen.pilot.pause()
    assert navigator.goals[-1][:2] == (1.0, 2.0)
    assert not navigator.asked


async def test_keys_act_in_the_order_in_which_they_are_typed(screen: AppScreen, store: WaypointStore) -> None:
    press_at_once(screen.app, ["w", "space", *"homf", "backspace", "e", "enter", "l", "enter", "x", "g"])
    await screen.pilot.pause()
    assert list(store.places()) == ["home"]
    assert not screen.panel.is_open
    assert screen.app.query_one(CommandLine).value == "xg"


@pytest.mark.parametrize("size", [(100, 36), SMALL], ids=str)
async def test_program_runs_without_colours(
    navigator: Any, store: WaypointStore, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings(), title="maze")
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        await pilot.press("question_mark", "x", "l", "enter", "x")
        await pilot.resize_terminal(size[0] + 7, size[1] + 3)
        await pilot.pause()
        assert "no goal" in screen_text(pilot)


async def test_resize_while_a_goal_is_driven_and_help_is_open(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    await screen.pilot.press("question_mark")
    for step in range(10):
        navigator.move(Pose2(0.1 * step, 0.0, 0.0))
        await screen.pilot.resize_terminal(20 + 8 * step, 3 + 4 * step)
        await screen.refresh()
    await screen.pilot.press("x")
    assert "driving" in screen_text(screen.pilot)


async def test_small_screen_shows_a_whole_alarm(small: AppScreen, navigator: Any) -> None:
    navigator.seen = replace(navigator.seen, mux=MuxView(stopped=True))
    await small.refresh()
    await small.pilot.pause()
    shown = " ".join(screen_text(small.pilot).split())
    assert "EMERGENCY STOP: r and Enter let the robot drive again" in shown


async def test_small_screen_shows_a_whole_message_and_the_emergency_key(small: AppScreen) -> None:
    await small.type("foo")
    await small.pilot.pause()
    shown = " ".join(screen_text(small.pilot).split())
    assert "unknown command 'foo', expected g X Y, m NAME, s, e, ... (? lists all)" in shown
    assert "Space: emergency stop ?: help" in shown


async def test_help_scrolls_to_its_end_on_a_small_screen(small: AppScreen) -> None:
    await small.pilot.press("question_mark")
    await small.pilot.pause()
    assert "scroll, others close" in screen_text(small.pilot)
    await small.pilot.press("end")
    await small.pilot.pause()
    assert small.panel.is_open
    assert "twice while" in screen_text(small.pilot)


async def test_exception_ends_the_program_and_is_kept_for_the_report(navigator: Any, store: WaypointStore) -> None:
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings())
    navigator.snapshot = None  # calling it raises
    await asyncio.wait_for(app.run_async(headless=True, size=(80, 24)), 60)
    assert app.return_code == 1
    assert isinstance(app.problem, TypeError)


async def test_coordinates_are_never_a_negative_zero(screen: AppScreen, navigator: Any) -> None:
    navigator.move(Pose2(-0.001, -0.004, -0.001))
    await screen.type("w here")
    assert "-0" not in screen.text("status") + screen.text("message")
    view = screen.app.map.view
    column, row = view.to_pixel(-0.02, 0.02)
    await screen.pilot.hover(MapView, offset=(int(column), int(row / 2)))
    await screen.refresh()
    assert "-0.0 " not in str(screen.app.query_one("#head", Static).render())


@pytest.mark.parametrize(
    ("columns", "shown"),
    [
        (40, "Space: emergency stop   ?: help"),
        (46, "Space: emergency stop   ?: help   q: quit"),
        (120, "Space: emergency stop   ?: help   q: quit   g X Y   m NAME   n: save what happened"),
    ],
)
async def test_hint_line_has_whole_hints_only(navigator: Any, store: WaypointStore, columns: int, shown: str) -> None:
    async with open_app(navigator, store, (columns, 30)) as screen:
        assert screen.app.query_one(CommandLine).placeholder == shown
