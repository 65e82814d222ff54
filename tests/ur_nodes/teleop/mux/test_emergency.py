from __future__ import annotations

import pytest

from ur_nodes.teleop.mux.emergency import (
    MuxRequest,
    MuxView,
    describe_emergency,
    describe_refusal,
    mux_request_of,
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
