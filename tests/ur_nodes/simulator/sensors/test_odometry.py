import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from ur.robot.base import Base, OdometryErrors
from ur_nodes.simulator.sensors.odometry import EncoderOdometry


def roll(base: Base, seed: int, left: float, right: float, steps: int = 100) -> EncoderOdometry:
    """Roll the wheels by so many metres."""
    odometry = EncoderOdometry(base, np.random.default_rng(seed))
    for n in range(steps + 1):
        part = n / steps / base.wheels.radius
        odometry.update(left * part, right * part, n * 0.05)
    return odometry


def roll_aside(base: Base, seed: int, distance: float, turn: float = 0.0, steps: int = 20) -> EncoderOdometry:
    """Drive to the left by so many metres, and turn by so many rad."""
    odometry = EncoderOdometry(base, np.random.default_rng(seed))
    rolled = turn * base.wheels.separation / 2.0 / base.wheels.radius
    for n in range(steps + 1):
        part = n / steps
        odometry.update(-rolled * part, rolled * part, n * 0.05, distance * part)
    return odometry


def with_errors(base: Base, **errors: Any) -> Base:
    perfect = OdometryErrors(rate=20.0, ticks_per_turn=100_000, wheel_noise=0.0, radius_error=0.0, separation_error=0.0)
    return dataclasses.replace(base, odometry=dataclasses.replace(perfect, **errors))


def test_odometry_without_errors_is_exact(stage: Base) -> None:
    base = with_errors(stage)
    assert roll(base, 0, 1.0, 1.0).pose == pytest.approx((1.0, 0.0, 0.0), abs=1e-4)
    quarter = math.pi / 2 * base.wheels.separation / 2
    assert roll(base, 0, -quarter, quarter).pose == pytest.approx((0.0, 0.0, math.pi / 2), abs=1e-3)
    inner, outer = math.pi / 2 * (1.0 - base.wheels.separation / 2), math.pi / 2 * (1.0 + base.wheels.separation / 2)
    assert roll(base, 0, inner, outer).pose == pytest.approx((1.0, 1.0, math.pi / 2), abs=1e-3)


def test_odometry_velocity_is_the_mean_since_the_last_reading(stage: Base) -> None:
    assert roll(with_errors(stage), 0, 1.0, 1.0).velocity == pytest.approx((1.0 / 5.0, 0.0, 0.0), abs=1e-3)


def test_odometry_counts_whole_ticks(stage: Base) -> None:
    base = with_errors(stage, ticks_per_turn=10)
    tick = 2 * math.pi * base.wheels.radius / 10
    assert roll(base, 0, 3.9 * tick, 3.9 * tick).pose[0] == pytest.approx(3 * tick)


def test_odometry_noise_grows_with_the_square_root_of_the_distance(stage: Base) -> None:
    base = with_errors(stage, wheel_noise=0.01)
    for distance in (1.0, 4.0):
        lengths = [roll(base, seed, distance, distance, 20).pose[0] for seed in range(300)]
        # Two wheels whose errors are independent: their mean is off by 1/sqrt(2) of one.
        assert np.std(lengths) == pytest.approx(0.01 * math.sqrt(distance) / math.sqrt(2), rel=0.15)
        assert np.mean(lengths) == pytest.approx(distance, abs=0.01)


def test_odometry_fixed_errors_are_those_of_a_robot_that_is_not_calibrated(stage: Base) -> None:
    base = with_errors(stage, radius_error=0.01)
    lengths = [roll(base, seed, 2.0, 2.0, 4).pose[0] for seed in range(300)]
    yaws = [roll(base, seed, 2.0, 2.0, 4).pose[2] for seed in range(300)]
    assert np.std(yaws) == pytest.approx(2.0 * 0.01 * math.sqrt(2) / base.wheels.separation, rel=0.15)
    assert np.mean(lengths) == pytest.approx(2.0, abs=0.01)


def test_odometry_covariance_tells_the_random_error(stage: Base) -> None:
    base = with_errors(stage, wheel_noise=0.004)
    runs = [roll(base, seed, 2.0, 2.0, 20) for seed in range(300)]
    xx, _, _, yy, _, ww = runs[0].covariance
    assert math.sqrt(xx) == pytest.approx(np.std([run.pose[0] for run in runs]), rel=0.2)
    assert math.sqrt(yy) == pytest.approx(np.std([run.pose[1] for run in runs]), rel=0.2)
    assert math.sqrt(ww) == pytest.approx(np.std([run.pose[2] for run in runs]), rel=0.2)


def test_odometry_of_the_same_seed_is_the_same(stage: Base) -> None:
    assert roll(stage, 3, 1.0, 1.2).pose == roll(stage, 3, 1.0, 1.2).pose
    assert roll(stage, 3, 1.0, 1.2).pose != roll(stage, 4, 1.0, 1.2).pose


@pytest.fixture
def omni(stage: Base) -> Base:
    return dataclasses.replace(stage, limits=dataclasses.replace(stage.limits, lateral_velocity=0.4))


def test_odometry_of_an_omni_base_counts_motion_to_the_left(omni: Base) -> None:
    base = with_errors(omni)
    assert roll_aside(base, 0, 1.0).pose == pytest.approx((0.0, 1.0, 0.0), abs=1e-4)
    assert roll_aside(base, 0, 1.0).velocity == pytest.approx((0.0, 0.0, 1.0), abs=1e-3)
    assert roll_aside(base, 0, math.pi / 2, math.pi / 2).pose == pytest.approx((-1.0, 1.0, math.pi / 2), abs=3e-3)


def test_odometry_of_an_omni_base_is_off_to_the_left_as_its_covariance_tells(omni: Base) -> None:
    base = with_errors(omni, wheel_noise=0.004)
    runs = [roll_aside(base, seed, 2.0) for seed in range(300)]
    xx, _, _, yy, _, ww = runs[0].covariance
    assert math.sqrt(xx) == pytest.approx(np.std([run.pose[0] for run in runs]), rel=0.2)
    assert math.sqrt(yy) == pytest.approx(np.std([run.pose[1] for run in runs]), rel=0.2)
    assert math.sqrt(ww) == pytest.approx(np.std([run.pose[2] for run in runs]), rel=0.2)
    scales = [roll_aside(with_errors(omni, radius_error=0.01), seed, 2.0).pose[1] for seed in range(300)]
    assert np.std(scales) == pytest.approx(2.0 * 0.01, rel=0.15)


def test_odometry_of_a_wheeled_base_draws_the_same_random_numbers_as_without_an_aside_motion(stage: Base) -> None:
    one, other = np.random.default_rng(5), np.random.default_rng(5)
    odometry = EncoderOdometry(stage, one)
    other.standard_normal(3)
    for n in range(4):
        odometry.update(n, n, n * 0.05)
    other.standard_normal(6)
    assert one.random() == other.random()
