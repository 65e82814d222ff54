import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.prediction import OdometryModel, is_still, with_measured_turn

RANDOM = np.random.default_rng(3)


def motions(count: int) -> list[tuple[Pose2, Pose2]]:
    """Reported and true motions: the odometry is 5 % long and turns 3 degrees a metre."""
    pairs = []
    for _ in range(count):
        way, turn = float(RANDOM.uniform(0.2, 0.5)), float(RANDOM.uniform(-0.3, 0.3))
        true = Pose2(way * math.cos(turn / 2.0), way * math.sin(turn / 2.0), turn)
        long, more = 1.05 * way, turn + math.radians(3.0) * way
        pairs.append((Pose2(long * math.cos(more / 2.0), long * math.sin(more / 2.0), more), true))
    return pairs


def test_errors_that_stay_are_learned() -> None:
    model = OdometryModel()
    for reported, true in motions(60):
        model.learn(reported, true)
    reported, true = motions(1)[0]
    corrected = model.correct(reported)
    assert corrected.x == pytest.approx(true.x, abs=0.004)
    assert corrected.y == pytest.approx(true.y, abs=0.004)
    assert corrected.yaw == pytest.approx(true.yaw, abs=0.006)


def test_wheels_that_slip_once_teach_nothing() -> None:
    model = OdometryModel()
    for reported, true in motions(60):
        model.learn(reported, true)
    before = model.correct(Pose2(0.4, 0.0, 0.1))
    model.learn(Pose2(0.5, 0.0, 0.0), Pose2(0.02, 0.0, 0.0))
    assert model.correct(Pose2(0.4, 0.0, 0.1)) == before


def test_longer_motions_are_less_certain() -> None:
    model = OdometryModel()
    short, long = model.covariance(Pose2(0.1, 0.0, 0.0)), model.covariance(Pose2(0.5, 0.0, 0.0))
    assert (np.diag(long) > np.diag(short)).all()


def test_measured_turn_replaces_that_of_the_wheels_and_is_more_certain() -> None:
    wheels, covariance = Pose2(0.5, 0.0, 0.0), np.diag((0.01, 0.01, 0.04))
    motion, exact = with_measured_turn(wheels, covariance, 0.2)
    assert motion.yaw == 0.2
    assert math.hypot(motion.x, motion.y) == pytest.approx(0.5)
    assert exact[2, 2] < 0.001
    assert (exact[:2, :2] == covariance[:2, :2]).all()


def test_robot_is_at_rest_when_neither_length_nor_turn_is_reported() -> None:
    assert is_still(Pose2(0.001, 0.001, -0.001))
    assert not is_still(Pose2(0.0, 0.003, 0.0))
    assert not is_still(Pose2(0.0, 0.0, -0.003))


def test_motions_to_the_side_are_learned_and_predicted_as_those_ahead() -> None:
    model = OdometryModel()
    for reported, true in motions(60):
        model.learn(reported, true)
    true = Pose2(0.02, 0.3, 0.0)
    for _ in range(2):
        reported = Pose2(1.05 * true.x, 1.05 * true.y, 0.0)
        off = true.inverse().compose(model.correct(reported))
        spread = np.sqrt(np.diag(model.covariance(reported)))
        assert (np.abs(off) < 2.0 * spread).all(), "what wheels turn ahead they do not turn to the side"
        for _ in range(40):
            model.learn(reported, true)
    assert math.hypot(off.x, off.y) < 0.004
