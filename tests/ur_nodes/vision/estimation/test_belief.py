import math

import numpy as np
import pytest
from tests.ur_nodes.vision.estimation.test_mapping import markers
from tests.ur_nodes.vision.estimation.test_robustness import known
from tests.ur_nodes.vision.synthetic import drift, drive, look

from ur_nodes.geometry.pose import Pose2
from ur_nodes.vision.estimation.localise import UNKNOWN_ERRORS, Belief, FiducialLocaliser, guess

HERE = Pose2(0.0, 0.0, 0.0)
EXACT = np.diag(np.square([0.001, 0.001, 0.001]))


def ahead(belief: Belief, steps: int, said: Pose2) -> Belief:
    for _ in range(steps):
        belief = belief.predict(said)
    return belief


def test_motion_is_added_in_the_robots_frame() -> None:
    turned = Belief(Pose2(1.0, 2.0, math.pi / 2), EXACT, UNKNOWN_ERRORS).predict(Pose2(0.5, 0.0, 0.1))
    assert np.allclose(turned.pose, (1.0, 2.5, math.pi / 2 + 0.1))


def test_standing_still_costs_no_certainty() -> None:
    belief = ahead(guess(HERE, UNKNOWN_ERRORS), 50, HERE)
    assert np.array_equal(belief.covariance, guess(HERE, UNKNOWN_ERRORS).covariance)


def test_heading_that_is_uncertain_makes_the_way_ahead_uncertain_to_the_side() -> None:
    belief = ahead(Belief(HERE, np.diag([1e-6, 1e-6, 0.1**2]), UNKNOWN_ERRORS), 20, Pose2(0.1, 0.0, 0.0))
    assert math.sqrt(belief.covariance[1, 1]) > 0.2  # 0.1 rad over 2 m
    assert math.sqrt(belief.covariance[0, 0]) < 0.1


def test_errors_of_the_wheels_are_told_by_where_the_robot_turns_out_to_be() -> None:
    belief = ahead(Belief(HERE, EXACT, UNKNOWN_ERRORS), 20, Pose2(0.05, 0.0, 0.0))
    told = belief.correct(Pose2(0.98, -0.01, -0.03), EXACT)  # 1 m straight on, the wheels said
    per_m, turn_per_m, turn_per_rad = told.errors.values
    assert -0.02 < per_m < -0.005
    assert -0.03 < turn_per_m < -0.005
    assert turn_per_rad == pytest.approx(0.0, abs=1e-6)  # nothing was turned
    assert np.diag(told.errors.covariance)[1] < np.diag(belief.errors.covariance)[1]
    assert np.linalg.eigvalsh(told.errors.covariance).min() > 0.0
    straight = told.predict(Pose2(0.5, 0.0, 0.0)).pose
    assert straight.yaw < -0.03


def test_robot_learns_on_the_way_how_its_wheels_err_and_strays_less_where_it_sees_nothing() -> None:
    random = np.random.default_rng(0)
    learned, naive = FiducialLocaliser(known().values(), start=HERE), FiducialLocaliser(known().values(), start=HERE)
    lap = [(0.0, 0.0), (8.2, 0.0), (8.2, 1.3), (7.6, 3.0), (7.8, 5.6)]
    for pose, said in drift(drive(lap), random):
        seen = look(pose, markers(), random)
        learned.add(said, seen)
    # The wheels of `drift` are 1 % long, turn by 0.004 rad a metre, and by 1.5 % too much.
    assert np.allclose(learned.errors.values, (-0.01, -0.004, -0.015), atol=0.008)
    learned.set_pose(HERE)
    offs = []
    for pose, said in drift(drive([(0.0, 0.0), (6.0, 0.0), (6.0, 6.0)]), random):
        for localiser in (learned, naive):
            localiser.add(said, ())
        believed = [localiser.robot(said) for localiser in (learned, naive)]
        offs.append([math.hypot(each.x - pose.x, each.y - pose.y) for each in believed if each])
    assert offs[-1][0] < 0.6 * offs[-1][1]
