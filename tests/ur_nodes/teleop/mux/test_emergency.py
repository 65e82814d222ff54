from __future__ import annotations

import pytest

from ur_nodes.motion.obstacle_stop.report import OFF, Report, State
from ur_nodes.teleop.mux.emergency import (
    MuxRequest,
    MuxView,
    describe_emergency,
    describe_obstacles,
    describe_refusal,
    mux_request_of,
    obstacle_request_of,
    view_of,
)
from ur_nodes.teleop.terminal.keys import FocusLost, Key, KeyEvent


def test_mux_that_is_gone_is_not_believed_any_more() -> None:
    assert view_of(True, True, "joystick", None, "") == MuxView(True, "joystick")
    assert view_of(False, True, "joystick", "stop", "late") == MuxView(None, "", "stop", "late")
    assert view_of(True, False, "idle", None, "").active == ""


@pytest.mark.parametrize(
    ("view", "text"),
    [
        (MuxView(), ""),
        (MuxView(False, "joystick"), ""),
        (MuxView(False, asked="release"), ""),
        (MuxView(False, asked="stop"), "emergency stop requested, no answer yet"),
        (MuxView(True), "EMERGENCY STOP: press r"),
        (MuxView(True, asked="release"), "EMERGENCY STOP: press r"),
        (MuxView(problem=describe_refusal("stop", "gone")), "NOT STOPPED: gone"),
        (MuxView(True, problem=describe_refusal("release", "gone")), "not released: gone"),
    ],
)
def test_people_are_told_what_they_have_to_know(view: MuxView, text: str) -> None:
    assert describe_emergency(view, "press r") == text


def test_obstacles_are_described_while_they_matter() -> None:
    stopped = MuxView(False, obstacles=Report("stopped", "stopped: obstacle close ahead"))
    assert describe_obstacles(stopped) == "stopped: obstacle close ahead"
    assert describe_obstacles(MuxView(False, obstacles=Report("clear"))) == ""
    assert describe_obstacles(MuxView(False, obstacles=OFF), "; g turns it on").endswith("is off; g turns it on")


@pytest.mark.parametrize(
    ("state", "expected"),
    [("none", None), ("off", "obstacles on"), ("clear", "obstacles off"), ("stopped", "obstacles off")],
)
def test_one_key_turns_the_obstacle_stop_off_and_on(state: State, expected: MuxRequest | None) -> None:
    view = MuxView(False, obstacles=Report(state))
    assert obstacle_request_of(Key("g"), view) == expected
    assert obstacle_request_of(Key("g", "repeat"), view) is None
    assert obstacle_request_of(Key("i"), view) is None
    assert obstacle_request_of(FocusLost(), view) is None


@pytest.mark.parametrize(
    ("event", "expected"),
    [
        (Key("space"), "stop"),
        (Key("r"), "release"),
        (Key("space", "release"), None),
        (Key("space", "repeat"), None),
        (Key("r", ctrl=True), None),
        (Key("i"), None),
        (FocusLost(), None),
    ],
)
def test_keys_ask_once_as_they_are_pressed(event: KeyEvent, expected: MuxRequest | None) -> None:
    assert mux_request_of(event) == expected
