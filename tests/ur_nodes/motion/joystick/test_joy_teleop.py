from dataclasses import replace

import pytest

from ur_nodes.motion.joystick.device import JoystickState
from ur_nodes.motion.joystick.joy_teleop import (
    ButtonRequest,
    JoyTeleopSettings,
    JoyTeleopState,
    JoyTwist,
    Speeds,
    step_joy_teleop,
)

ENABLE, TURBO, STOP, RELEASE = 4, 5, 1, 7
SETTINGS = JoyTeleopSettings(
    {"x": 1},
    {"yaw": 0},
    Speeds({"x": 0.3}, {"yaw": 0.6}),
    Speeds({"x": 0.9}, {"yaw": 2.0}),
    enable_button=ENABLE,
    enable_turbo_button=TURBO,
    stop_button=STOP,
    release_button=RELEASE,
    speed_limit=0.5,
    turn_limit=1.0,
)


def at(x: float, yaw: float, *pressed: int) -> JoystickState:
    return JoystickState((yaw, x), tuple(int(n in pressed) for n in range(8)))


def replay(
    *reports: JoystickState, settings: JoyTeleopSettings = SETTINGS
) -> list[tuple[JoyTwist | None, ButtonRequest | None]]:
    state, outcome = JoyTeleopState(settings), []
    for report in reports:
        state, twist, request = step_joy_teleop(state, report)
        outcome.append((twist, request))
    return outcome


def twist(x: float, yaw: float) -> JoyTwist:
    return JoyTwist((x, 0.0, 0.0), (0.0, 0.0, yaw))


def test_nothing_moves_without_the_dead_man_button() -> None:
    assert replay(at(1.0, 1.0), at(1.0, 1.0, 0, 2, 3)) == [(None, None)] * 2


def test_dead_man_button_drives_and_letting_go_stops_then_silence() -> None:
    outcome = replay(at(0.5, -1.0, ENABLE), *[at(0.5, -1.0)] * 5)
    assert outcome[0][0] == twist(0.15, -0.6)
    assert [sent for sent, _ in outcome[1:]] == [JoyTwist()] * 3 + [None] * 2


def test_turbo_drives_faster_but_within_the_limits_of_the_base() -> None:
    assert replay(at(1.0, 1.0, TURBO)) == [(twist(0.5, 1.0), None)]
    assert replay(at(0.5, 0.25, ENABLE, TURBO)) == [(twist(0.45, 0.5), None)]


def test_emergency_buttons_speak_once_for_each_press() -> None:
    outcome = replay(at(0, 0, STOP), at(0, 0, STOP), at(0, 0), at(0, 0, STOP), at(0, 0, RELEASE))
    assert [request for _, request in outcome] == ["stop", None, None, "stop", "release"]


def test_stop_wins_when_both_are_pressed() -> None:
    assert replay(at(0, 0, STOP, RELEASE))[0][1] == "stop"


@pytest.mark.parametrize("report", [JoystickState(), JoystickState((0.5,), (0, 0, 0, 0, 1))])
def test_joystick_with_fewer_axes_does_not_move(report: JoystickState) -> None:
    sent = replay(report)[0][0]
    assert sent is None or sent.linear == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_axis_that_is_no_finite_number_does_not_move_the_robot(value: float) -> None:
    assert replay(at(value, value, ENABLE), at(value, 0.5, TURBO)) == [(JoyTwist(), None), (twist(0.0, 1.0), None)]


def test_no_dead_man_button_means_no_motion() -> None:
    without = replace(SETTINGS, enable_button=-1, enable_turbo_button=-1)
    assert replay(at(1.0, 0.0, 0, 4, 5), settings=without)[0][0] is None
