import pytest

from ur_nodes.client.mux import (
    MuxView,
    describe_emergency,
    describe_obstacles,
    describe_refusal,
    view_of,
)
from ur_nodes.motion.obstacle_stop.report import OFF, ObstacleReport


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
    stopped = MuxView(False, obstacles=ObstacleReport("stopped", "stopped: obstacle close ahead"))
    assert describe_obstacles(stopped) == "stopped: obstacle close ahead"
    assert describe_obstacles(MuxView(False, obstacles=ObstacleReport("clear"))) == ""
    assert describe_obstacles(MuxView(False, obstacles=OFF), "; g turns it on").endswith("is off; g turns it on")
