import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.base_contract import load

from ur.robot.base import Base
from ur_nodes.motion.ramp import WheelDrive

PERIOD = 0.02


@pytest.fixture(scope="module")
def stage() -> Base:
    return load("stage", "")


def run(drive: WheelDrive, linear: float, angular: float, seconds: float) -> list[tuple[float, float]]:
    reached = []
    for n in range(round(seconds / PERIOD)):
        drive.command(linear, angular, n * PERIOD)
        drive.update(n * PERIOD)
        reached.append(drive.velocity)
    return reached


@given(linear=st.floats(), angular=st.floats())
def test_drive_never_exceeds_the_limits_of_the_base(stage: Base, linear: float, angular: float) -> None:
    limits = stage.limits
    before = (0.0, 0.0)
    for v, w in run(WheelDrive(stage, PERIOD), linear, angular, 1.5):
        assert abs(v) <= limits.velocity
        assert abs(w) <= limits.angular_velocity
        grows, turns = abs(v) > abs(before[0]), abs(w) > abs(before[1])
        assert abs(v - before[0]) <= (limits.acceleration if grows else limits.deceleration) * PERIOD + 1e-12
        assert (
            abs(w - before[1])
            <= (limits.angular_acceleration if turns else limits.angular_deceleration) * PERIOD + 1e-12
        )
        before = (v, w)


def test_drive_reaches_what_is_commanded(stage: Base) -> None:
    assert run(WheelDrive(stage, PERIOD), 0.3, -0.4, 1.0)[-1] == (0.3, -0.4)


def test_drive_wheel_speeds_follow_from_the_geometry(stage: Base) -> None:
    drive = WheelDrive(stage, 10.0)
    drive.command(0.2, 0.5, 0.0)
    left, right = drive.update(0.0)
    assert (left + right) / 2 * stage.wheels.radius == pytest.approx(0.2)
    assert (right - left) * stage.wheels.radius / stage.wheels.separation == pytest.approx(0.5)


def test_drive_ramps_down_once_the_command_is_old(stage: Base) -> None:
    drive = WheelDrive(stage, PERIOD)
    last = round(1.0 / PERIOD) * PERIOD - PERIOD
    run(drive, 0.5, 0.0, 1.0)
    age = stage.limits.command_age
    drive.update(last + age - 0.001)
    assert drive.velocity[0] == 0.5
    drive.update(last + age + 0.001)
    assert drive.velocity[0] == pytest.approx(0.5 - stage.limits.deceleration * PERIOD)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_drive_takes_a_command_that_is_not_finite_as_stop(stage: Base, bad: float) -> None:
    drive = WheelDrive(stage, PERIOD)
    run(drive, 0.5, 0.0, 1.0)
    assert run(drive, bad, 0.5, 1.0)[-1] == (0.0, 0.0)


def test_drive_ramps_to_the_side_only_where_the_wheels_roll_sideways(stage: Base) -> None:
    omni = dataclasses.replace(stage, limits=dataclasses.replace(stage.limits, lateral_velocity=0.3))
    for base, reached in ((stage, 0.0), (omni, -0.3)):
        drive = WheelDrive(base, PERIOD)
        drive.command(0.0, 0.0, 0.0, -5.0)
        drive.update(0.0)
        assert abs(drive.aside) <= base.limits.acceleration * PERIOD + 1e-12
        for n in range(200):
            drive.command(0.0, 0.0, n * PERIOD, -5.0)
            assert drive.update(n * PERIOD) == (0.0, 0.0)
        assert drive.aside == pytest.approx(reached)
        drive.halt()
        assert drive.aside == 0.0
