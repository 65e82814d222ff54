"""The search over place and heading."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.navigation.planning.outline_grid import blocked_headings, heading_number, make_stamp
from ur_nodes.navigation.planning.outline_motions import LEFT, MotionPose, Steering
from ur_nodes.navigation.planning.outline_search import SearchGrid, find_motions

CELL = 0.05
ROBOT = footprint_of_outline(((0.4, 0.2), (-0.4, 0.2), (-0.4, -0.2), (0.4, -0.2)), CELL)


def grid_of(lethal: NDArray[np.bool_], goal: tuple[float, float]) -> SearchGrid:
    """The grid of a room with obstacles; what is ahead is the distance as the crow flies."""
    rows, columns = np.indices(lethal.shape)
    ahead = np.hypot((columns + 0.5) * CELL - goal[0], (rows + 0.5) * CELL - goal[1])
    blocked = blocked_headings(lethal, make_stamp(ROBOT, CELL, 0.0))
    narrow = blocked_headings(lethal, make_stamp(ROBOT, CELL, 0.0, CELL))
    return SearchGrid(blocked, narrow, np.where(lethal, math.inf, 1.0), ahead, CELL)


def room(height: float, width: float) -> NDArray[np.bool_]:
    lethal = np.zeros((round(height / CELL), round(width / CELL)), bool)
    lethal[[0, -1]] = lethal[:, [0, -1]] = True
    return lethal


def touches(grid: SearchGrid, motion: MotionPose) -> bool:
    row, column = int(motion.y / CELL), int(motion.x / CELL)
    return bool(int(grid.blocked[row, column]) >> heading_number(motion.yaw) & 1)


def test_robot_in_a_wide_room_drives_straight_to_a_pose_ahead() -> None:
    grid = grid_of(room(4.0, 4.0), (3.0, 2.0))
    found = find_motions(grid, (1.0, 2.0, 0.0), (3.0, 2.0, 0.0), Steering())
    assert {motion.gear for motion in found.motions[1:]} == {1}
    assert math.dist(found.motions[-1][:2], (3.0, 2.0)) < 0.08
    assert max(abs(motion.y - 2.0) for motion in found.motions) < 0.05


def test_robot_in_a_dead_end_too_narrow_to_turn_in_backs_out() -> None:
    lethal = room(4.0, 4.0)
    lethal[:32, 40:] = lethal[44:, 40:] = True  # 0.6 m wide
    grid = grid_of(lethal, (1.0, 2.0))
    found = find_motions(grid, (3.01, 1.91, 0.0), (1.01, 2.01, 3.14), Steering())
    assert found.motions[1].gear == -1
    assert abs(wrap_angle(found.motions[-1].yaw - 3.14)) < 0.06
    assert not any(touches(grid, motion) for motion in found.motions)


def test_robot_between_two_walls_drives_sideways_to_a_place_beside_it_and_keeps_its_heading() -> None:
    lethal = room(4.0, 4.0)
    lethal[:, :30] = lethal[:, 48:] = True  # 0.9 m apart, too narrow to turn
    grid = grid_of(lethal, (1.96, 3.0))
    found = find_motions(grid, (1.96, 1.0, 0.0), (1.96, 3.0, 0.0), Steering(sideways=True))
    assert {motion.gear for motion in found.motions[1:]} == {LEFT}
    assert {motion.yaw for motion in found.motions} == {0.0}
    assert math.dist(found.motions[-1][:2], (1.96, 3.0)) < 0.08
    assert not find_motions(grid, (1.96, 1.0, 0.0), (1.96, 3.0, 0.0), Steering()).motions


def test_place_behind_a_gap_that_is_too_narrow_is_not_reached_and_all_was_searched() -> None:
    lethal = room(1.6, 2.4)
    lethal[:, 24] = True
    lethal[13:19, 24] = False
    grid = grid_of(lethal, (2.0, 0.8))
    found = find_motions(grid, (0.6, 0.8, 0.0), (1.9, 0.8, 0.0), Steering())
    assert (found.motions, found.whole) == ((), True)


@pytest.mark.parametrize("most", [0, 5])
def test_search_ends_after_as_many_states_as_are_allowed(most: int) -> None:
    grid = grid_of(room(4.0, 6.0), (5.0, 3.0))
    found = find_motions(grid, (1.0, 1.0, 3.1), (5.0, 3.0, 1.0), Steering(radius=0.8), most=most)
    assert (found.motions, found.expanded, found.whole) == ((), most, False)


def test_robot_that_cannot_turn_on_the_spot_keeps_to_its_least_radius() -> None:
    grid = grid_of(room(6.0, 6.0), (3.0, 4.5))
    found = find_motions(grid, (2.0, 2.0, 0.0), (3.0, 4.5, 1.57), Steering(radius=0.8))
    assert found.motions
    assert all(motion.gear for motion in found.motions[1:])
    for a, b in pairwise(found.motions):
        assert abs(wrap_angle(b.yaw - a.yaw)) <= math.dist(a[:2], b[:2]) / 0.8 + math.tau / 64.0
