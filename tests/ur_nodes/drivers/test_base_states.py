import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.base import Wheels
from ur_nodes.drivers.base_states import HOLD, LONGEST_GAP, BumperStates, WheelStates

WHEELS = Wheels(radius=0.05, width=0.02, separation=0.3, mass=0.1)
speed = st.floats(-1.0, 1.0)


def test_first_call_tells_all_and_later_ones_what_changed() -> None:
    states = BumperStates(["left", "right"])
    assert states.changes(5.0) == {"left": False, "right": False}
    assert states.changes(5.1) == {}
    states.press("left", 5.2)
    assert states.changes(5.2) == {"left": True}
    states.press("left", 5.2 + HOLD)
    assert states.changes(5.3 + HOLD) == {}
    assert states.changes(5.3 + 2 * HOLD) == {"left": False}


def test_unknown_name_changes_nothing() -> None:
    states = BumperStates(["left"])
    states.changes(0.0)
    states.press("roof", 0.0)
    assert states.changes(0.0) == {}


def test_clock_that_jumps_back_releases_what_was_pressed() -> None:
    states = BumperStates(["left"])
    states.press("left", 100.0)
    assert states.changes(100.0) == {"left": True}
    assert states.changes(1.0) == {"left": False}


@given(st.lists(st.tuples(speed, speed), min_size=1, max_size=30))
def test_wheels_roll_as_far_as_the_base_moves_and_turns(motions: list[tuple[float, float]]) -> None:
    states = WheelStates(WHEELS)
    way = heading = 0.0
    last = motions[0]
    for number, motion in enumerate(motions):
        states.update(*motion, 0.05 * number)
        if number:
            way += 0.05 * (last[0] + motion[0]) / 2
            heading += 0.05 * (last[1] + motion[1]) / 2
        last = motion
    left, right = states.angles
    assert (left + right) / 2 * WHEELS.radius == pytest.approx(way, abs=1e-9)
    assert (right - left) * WHEELS.radius / WHEELS.separation == pytest.approx(heading, abs=1e-9)


def test_speeds_are_those_of_the_last_odometry() -> None:
    states = WheelStates(WHEELS)
    states.update(0.0, 1.0, 3.0)
    assert states.speeds == pytest.approx((-3.0, 3.0))
    assert states.angles == (0.0, 0.0)


@pytest.mark.parametrize(("forward", "turn"), [(math.nan, 0.0), (0.0, math.inf), (-1e300, 0.0), (0.0, 60.0)])
def test_odometry_that_no_base_can_have_turns_no_wheel(forward: float, turn: float) -> None:
    states = WheelStates(WHEELS)
    assert states.update(0.5, 0.0, 10.0)
    assert not states.update(forward, turn, 10.1)
    assert states.update(0.5, 0.0, 10.2)
    assert states.angles == pytest.approx((0.2 * 0.5 / WHEELS.radius,) * 2)


@pytest.mark.parametrize("gap", [LONGEST_GAP * 2, -1.0, 0.0])
def test_gap_in_odometry_turns_no_wheel(gap: float) -> None:
    states = WheelStates(WHEELS)
    states.update(1.0, 0.0, 10.0)
    states.update(1.0, 0.0, 10.0 + gap)
    assert states.angles == (0.0, 0.0)
    states.update(1.0, 0.0, 10.0 + gap + 0.1)
    assert not math.isclose(states.angles[0], 0.0)
