"""The map of the navigation screen: mouse, keys, colours."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen

from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import LIGHT, LIGHT_16
from ur_nodes.teleop.map_view.widget import MapView


async def test_click_sets_a_goal_there_for_which_any_heading_counts(screen: AppScreen, navigator: Any) -> None:
    view = screen.app.map.view
    await screen.pilot.click(MapView, offset=(70, 10))
    expected = view.to_map(70.5, 21.0)
    (goal,) = navigator.goals
    assert goal == pytest.approx((*expected, math.atan2(expected[1], expected[0])))  # for upstream's move_base
    assert navigator.any_heading


async def test_drag_sets_the_heading(screen: AppScreen, navigator: Any) -> None:
    view = screen.app.map.view
    await screen.pilot.mouse_down(MapView, offset=(50, 20))
    await screen.pilot.hover(MapView, offset=(50, 15))
    await screen.pilot.mouse_up(MapView, offset=(50, 15))
    (goal,) = navigator.goals
    assert goal == pytest.approx((*view.to_map(50.5, 41.0), math.pi / 2))
    assert not navigator.any_heading


def signs(screen: AppScreen) -> str:
    return "".join(text for line in screen.app.map._lines for text, _, _ in line if text in "◎→↗↑↖←↙↓↘")


async def test_arrow_is_shown_only_once_a_drag_is_long_enough(screen: AppScreen, navigator: Any) -> None:
    await screen.pilot.mouse_down(MapView, offset=(70, 10))
    await screen.pilot.hover(MapView, offset=(71, 10))
    assert "◎" in signs(screen)
    await screen.pilot.hover(MapView, offset=(72, 10))
    assert "◎" not in signs(screen)
    await screen.pilot.hover(MapView, offset=(71, 10))
    await screen.pilot.mouse_up(MapView, offset=(71, 10))
    assert len(navigator.goals) == 1
    assert navigator.any_heading


async def test_right_button_drags_the_map(screen: AppScreen, navigator: Any) -> None:
    before = screen.app.map.view.to_map(50, 20)
    await screen.pilot.mouse_down(MapView, offset=(50, 10), button=3)
    await screen.pilot.hover(MapView, offset=(60, 10))
    await screen.pilot.mouse_up(MapView, offset=(60, 10))
    assert screen.app.map.view.to_map(60, 20) == pytest.approx(before)
    assert not navigator.goals


@pytest.mark.parametrize("focus_map", [False, True])
async def test_keys_move_the_map(screen: AppScreen, focus_map: bool) -> None:
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


async def test_vi_keys_move_the_map_after_tab(screen: AppScreen) -> None:
    await screen.pilot.press("tab")
    whole = screen.app.map.view
    await screen.pilot.press("l", "k")
    assert (screen.app.map.view.x > whole.x, screen.app.map.view.y > whole.y) == (True, True)
    await screen.pilot.press("h", "j")
    assert (screen.app.map.view.x, screen.app.map.view.y) == pytest.approx((whole.x, whole.y))


async def test_following_keeps_the_robot_in_view(screen: AppScreen, navigator: Any) -> None:
    await screen.type("f")
    for x in (1.0, 2.0, 3.0, 4.0):
        navigator.move(Pose2(x, 0.0, 0.0))
        await screen.refresh()
        column, _ = screen.app.map.view.to_pixel(x, 0.0)
        assert 0.2 * 100 < column < 0.8 * 100
    assert "following the robot" in screen.text("head")


async def test_resize_shows_the_whole_map_again(screen: AppScreen, navigator: Any) -> None:
    await screen.pilot.resize_terminal(60, 20)
    await screen.pilot.pause()
    view = screen.app.map.view
    left, bottom, right, top = navigator.seen.grid.bounds
    assert view.width == 60
    assert view.to_pixel(left, bottom)[0] >= 0
    assert view.to_pixel(right, top)[0] <= 60


async def test_light_and_dark(screen: AppScreen) -> None:
    await screen.type("t")
    assert screen.app.theme == "textual-light"
    assert screen.app.map.palette in (LIGHT, LIGHT_16)


async def test_same_picture_is_not_drawn_again(
    screen: AppScreen, navigator: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[object] = []
    monkeypatch.setattr(screen.app.map, "redraw", lambda: drawn.append(None))
    navigator.seen = replace(navigator.seen)
    await screen.refresh()
    assert not drawn
    navigator.seen = replace(navigator.seen, scan=np.array([[1.0, 1.0]]))
    await screen.refresh()
    assert len(drawn) == 1
