"""Ways of arcs and a line between poses."""

import math
from itertools import pairwise

import numpy as np
import pytest

from ur_nodes.navigation.planning.outline_search import list_shots


@pytest.mark.parametrize("seed", range(8))
def test_ways_lead_to_the_pose_in_bends_that_are_wide_enough(seed: int) -> None:
    (x, y, yaw), (goal_x, goal_y, goal_yaw) = np.random.default_rng(seed).uniform(-3.0, 3.0, (2, 3)).tolist()
    start, goal = (x, y, yaw), (goal_x, goal_y, goal_yaw)
    ways = list_shots(start, goal, 0.9, math.inf)
    assert len(ways) >= 4
    for way in ways:
        assert way[-1] == goal
        for before, pose in pairwise([start, *way]):
            assert math.dist(before[:2], pose[:2]) < 0.06
            assert abs(math.remainder(pose[2] - before[2], math.tau)) < 0.06 / 0.9 + 1e-6


def test_shortest_way_comes_first_and_those_that_are_too_long_do_not() -> None:
    ways = list_shots((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5, 2.5)
    assert len(ways) >= 1
    assert max(abs(y) for _, y, _ in ways[0]) < 1e-6
    assert list_shots((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 0.5, 1.9) == []
    lengths = [len(way) for way in list_shots((0.0, 0.0, 0.0), (1.0, 1.0, 3.0), 0.5, math.inf)]
    assert lengths == sorted(lengths)
