import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.pose_graph.graph import PoseGraph

COVARIANCE = np.diag(np.square((0.02, 0.02, 0.02)))


def square(turn: float) -> PoseGraph:
    """Four sides of 4 m in steps of 1 m, with a turn (rad) too many in each step."""
    graph = PoseGraph()
    graph.add_pose(Pose2(0.0, 0.0, 0.0))
    for number in range(16):
        relative = Pose2(1.0, 0.0, (math.pi / 2.0 if number % 4 == 3 else 0.0) + turn)
        graph.add_pose(graph.poses[-1].compose(relative))
        graph.add_edge(number, number + 1, relative, COVARIANCE, robust=False)
    return graph


def test_loop_spreads_the_error_over_its_poses() -> None:
    graph = square(0.02)
    assert math.hypot(*graph.poses[16][:2]) > 0.3
    graph.add_edge(0, 16, Pose2(0.0, 0.0, 0.0), 0.01 * COVARIANCE, robust=True)
    graph.optimise()
    assert math.hypot(*graph.poses[16][:2]) < 0.02
    assert math.hypot(graph.poses[8].x - 4.0, graph.poses[8].y - 4.0) < 0.2


def test_first_pose_stays() -> None:
    graph = square(0.02)
    graph.add_edge(0, 16, Pose2(0.0, 0.0, 0.0), COVARIANCE, robust=True)
    graph.optimise()
    assert graph.poses[0] == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)


def test_loop_that_contradicts_all_others_is_outvoted() -> None:
    graph = square(0.0)
    for number in range(4):
        graph.add_edge(number, 16, graph.poses[number].inverse().compose(graph.poses[16]), COVARIANCE, robust=True)
    graph.add_edge(2, 14, Pose2(3.0, 3.0, 1.0), COVARIANCE, robust=True)
    graph.optimise()
    assert math.hypot(*graph.poses[16][:2]) < 0.05


def test_confirmed_loops_close_where_odometry_was_much_worse_than_expected() -> None:
    graph, count, step = PoseGraph(), 100, 1.03  # 3 m too long, 6 standard deviations
    covariance = np.diag(np.square((0.05, 0.02, 0.002)))
    graph.add_pose(Pose2(0.0, 0.0, 0.0))
    for number in range(1, count):
        graph.add_pose(Pose2(number * step, 0.0, 0.0))
        graph.add_edge(number - 1, number, Pose2(step, 0.0, 0.0), covariance, robust=False)
    graph.optimise()
    for number in (0, 1):
        ends, true = (number, count - 1 - number), Pose2(count - 1.0 - 2 * number, 0.0, 0.0)
        graph.add_edge(*ends, true, 0.01 * COVARIANCE, robust=True, confirmed=True)
    graph.optimise()
    assert graph.poses[-1].x == pytest.approx(count - 1.0, abs=0.05)


def test_spread_grows_with_the_path_and_a_loop_shortens_it() -> None:
    graph = square(0.0)
    before = graph.spread_from(16, 10.0)
    assert before[16] == 0.0
    assert before[0] > before[12] > before[15]
    graph.add_edge(0, 16, Pose2(0.0, 0.0, 0.0), COVARIANCE, robust=True)
    assert graph.spread_from(16, 10.0)[0] < before[15] + 0.01
    assert np.isinf(graph.spread_from(16, 0.1)[8])


def test_drive_round_a_block_ends_less_uncertain_than_a_straight_one_as_long() -> None:
    turns = np.diag(np.square((0.001, 0.001, 0.02)))
    ends = []
    for corner in (0.0, math.pi / 2.0):
        graph = PoseGraph()
        graph.add_pose(Pose2(0.0, 0.0, 0.0))
        for number in range(16):
            relative = Pose2(1.0, 0.0, corner if number % 4 == 3 else 0.0)
            graph.add_pose(graph.poses[-1].compose(relative))
            graph.add_edge(number, number + 1, relative, turns, robust=False)
        ends.append(graph.spread_from(16, 10.0)[0])
    straight, block = ends
    assert straight == pytest.approx(0.02 * math.sqrt(16.0**3 / 3.0), rel=0.02)
    assert block < 0.5 * straight
