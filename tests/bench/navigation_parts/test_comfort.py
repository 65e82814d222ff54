import numpy as np
import pytest
from bench.navigation_parts.comfort import judge_comfort

from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Odometry, Poses, Twist

SQUARE = hull_of_outline(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
PERIOD = 100_000_000  # ns
PERSON = np.array(((1.0, 0.0, 0.0),))


def drive(*steps: tuple[float, float]) -> list[Odometry]:
    """The truth at places along x (m) with speeds (m/s), ten times a second."""
    matrix = np.eye(3)
    return [
        Odometry(number * PERIOD, "map", "base", Pose2(x, 0.0, 0.0), Twist(speed, 0.0), matrix, matrix)
        for number, (x, speed) in enumerate(steps)
    ]


def test_room_counts_while_the_robot_moves_only() -> None:
    truths = drive((0.0, 0.5), (0.2, 0.5), (0.4, 0.0), (0.2, -0.5))
    people = [Poses(truth.stamp, "map", PERSON) for truth in truths]
    comfort = judge_comfort(SQUARE, truths, people, 0)
    assert comfort.closest == pytest.approx(0.4)
    assert comfort.near == pytest.approx(0.2)


def test_a_rest_of_three_seconds_is_one_freeze() -> None:
    truths = drive(*[(0.0, 0.0)] * 25, (0.1, 0.5), *[(0.2, 0.0)] * 50)
    assert judge_comfort(SQUARE, truths, [], 0).freezes == 1
