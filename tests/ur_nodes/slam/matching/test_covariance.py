import math

import numpy as np
import pytest

from ur_nodes.slam.matching.match import position_deviation, rotate_covariance

LONG_X = np.diag(np.square((0.3, 0.1, 0.02)))


def test_covariance_along_x_lies_along_y_of_a_pose_that_faces_left() -> None:
    found = rotate_covariance(LONG_X, math.pi / 2.0)
    np.testing.assert_allclose(found, np.diag(np.square((0.1, 0.3, 0.02))), atol=1e-15)


def test_rotation_back_gives_the_covariance_again() -> None:
    mixed = rotate_covariance(LONG_X, 0.7)
    assert abs(mixed[0, 1]) > 0.01
    np.testing.assert_allclose(rotate_covariance(mixed, -0.7), LONG_X, atol=1e-15)


def test_deviation_of_the_position_is_that_of_its_worst_direction() -> None:
    assert position_deviation(LONG_X) == pytest.approx(0.3)
    assert position_deviation(rotate_covariance(LONG_X, 1.1)) == pytest.approx(0.3)
