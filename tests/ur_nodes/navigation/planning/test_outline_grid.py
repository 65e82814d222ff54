"""Where an outline touches something, as bits for headings."""

import math

import numpy as np
import pytest

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.outline_grid import (
    HEADINGS,
    blocked_headings,
    heading_angle,
    heading_number,
    make_stamp,
    overlaps,
)

CELL = 0.05


def long_robot() -> Footprint:
    return footprint_of_outline(((0.5, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.5, -0.2)), CELL)


@pytest.mark.parametrize("number", [0, 1, 16, 32, 33, 63])
def test_heading_has_the_number_of_its_angle(number: int) -> None:
    assert heading_number(heading_angle(number)) == number
    assert heading_number(heading_angle(number) + 3.0 * math.tau) == number
    assert -math.pi < heading_angle(number) <= math.pi


def test_bits_are_those_of_the_outline_itself_in_the_middle_of_a_cell() -> None:
    lethal = np.zeros((40, 40), bool)
    lethal[20, 28] = lethal[31, 5] = True
    costmap = Costmap(np.where(lethal, np.uint8(LETHAL), np.uint8(0)).astype(np.uint8), CELL, Pose2(0.0, 0.0, 0.0))
    blocked = blocked_headings(lethal, make_stamp(long_robot(), CELL, 0.0))
    for row, column in ((20, 20), (20, 24), (28, 8), (5, 5)):
        place = ((column + 0.5) * CELL, (row + 0.5) * CELL)
        poses = np.array([(*place, heading_angle(number)) for number in range(HEADINGS)])
        touching = overlaps(poses, costmap, long_robot()) > 0
        assert [bool(int(blocked[row, column]) >> n & 1) for n in range(HEADINGS)] == touching.tolist()


def test_room_round_the_outline_blocks_more_headings_and_never_fewer() -> None:
    lethal = np.zeros((40, 40), bool)
    lethal[:, 24] = True
    plain = blocked_headings(lethal, make_stamp(long_robot(), CELL, 0.0))
    wide = blocked_headings(lethal, make_stamp(long_robot(), CELL, 0.0, room=0.1))
    assert not (plain & ~wide).any()
    assert (wide & ~plain).any()


def test_cells_far_from_everything_have_all_headings() -> None:
    lethal = np.zeros((60, 60), bool)
    lethal[0, 0] = True
    assert not blocked_headings(lethal, make_stamp(long_robot(), CELL, 0.0))[30:, 30:].any()
