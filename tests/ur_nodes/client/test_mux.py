import pytest

from ur_nodes.client.mux import (
    MuxLink,
    MuxView,
    describe_emergency,
    describe_obstacles,
    describe_refusal,
)
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.obstacle_stop.report import OFF, ObstacleReport
from ur_nodes.ports.qualities import Quality


def test_state_of_a_mux_that_has_ended_is_unknown() -> None:
    bus = Bus()
    mux, link = bus.node("mux"), MuxLink(bus.node("client"), "mux")
    stopped, active = mux.publish("mux/stopped", bool, Quality.LATCHED), mux.publish("mux/active", str, Quality.LATCHED)
    stopped.send(True)
    active.send("joystick")
    bus.run(0.1)
    assert link.view() == MuxView(True, "joystick")
    active.send("idle")
    bus.run(0.1)
    assert link.view().active == ""
    mux.end("it has ended")
    assert link.view() == MuxView()


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
