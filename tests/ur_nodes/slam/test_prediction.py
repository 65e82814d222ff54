import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.prediction import UNKNOWN_MOTION, MotionPredictor

START = Pose2(3.0, -1.0, 0.4)
STEP = Pose2(0.2, 0.01, 0.1)


def test_motion_by_odometry_does_not_depend_on_where_odometry_began() -> None:
    predictor = MotionPredictor()
    predictor.add(START, None)
    found = predictor.predict(START.compose(STEP), None)
    assert found.motion == pytest.approx(STEP)
    assert found.wheels == found.motion
    assert not found.still
    assert np.all(np.diag(found.covariance) < np.diag(UNKNOWN_MOTION))


def test_without_odometry_the_robot_is_expected_to_move_on_as_before() -> None:
    predictor = MotionPredictor()
    predictor.add(None, None)
    predictor.add(None, None, STEP)
    found = predictor.predict(None, None)
    assert found.motion == STEP
    assert found.covariance is UNKNOWN_MOTION


def test_measured_heading_replaces_the_turn_of_the_wheels_and_not_their_distance() -> None:
    predictor = MotionPredictor()
    predictor.add(START, 7.0)
    found = predictor.predict(START.compose(STEP), 7.3)
    assert found.motion.yaw == pytest.approx(0.3)
    assert np.hypot(*found.motion[:2]) == pytest.approx(np.hypot(*STEP[:2]))
    assert found.wheels.yaw == pytest.approx(STEP.yaw)


def test_robot_is_at_rest_while_odometry_does_not_move() -> None:
    predictor = MotionPredictor()
    predictor.add(START, None)
    assert predictor.predict(START, None).still
    assert not MotionPredictor().predict(START, None).still


def test_last_scan_of_another_predictor_is_taken_over() -> None:
    other, predictor = MotionPredictor(), MotionPredictor()
    other.add(START, None, STEP)
    predictor.go_on_from(other)
    assert predictor.predict(None, None).motion == STEP
    assert predictor.predict(START.compose(STEP), None).motion == pytest.approx(STEP)
