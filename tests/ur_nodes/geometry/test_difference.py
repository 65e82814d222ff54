import math

import numpy as np
import pytest

from ur_nodes.geometry.difference import describe_poses, find_difference, name_direction
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


def two_rooms() -> Grid:
    """Two rooms of 5 m x 4 m side by side that look alike, but for a pillar in the north-east of the second one."""
    values = np.zeros((84, 204), dtype=np.int8)
    values[:2] = values[-2:] = 100
    values[:, :2] = values[:, 101:103] = values[:, -2:] = 100
    values[60:66, 180:186] = 100
    return Grid(values, 0.05, Pose2(0.0, 0.0, 0.0))


def test_difference_of_two_places_is_the_nearest_thing_that_only_one_has() -> None:
    first, second = Pose2(2.5, 2.0, 0.0), Pose2(7.5, 2.0, 0.0)
    found = find_difference(two_rooms(), first, second)
    assert found is not None
    assert found == pytest.approx((1.5, 1.0), abs=0.15)
    assert name_direction(*found) == "ahead to the left"
    turned = find_difference(two_rooms(), Pose2(2.5, 2.0, math.pi), Pose2(7.5, 2.0, math.pi))
    assert turned == pytest.approx((-1.5, -1.0), abs=0.15)
    assert name_direction(*turned or (0.0, 0.0)) == "behind to the right"


def test_places_that_the_map_does_not_tell_apart_differ_nowhere() -> None:
    values = two_rooms().values.copy()
    values[60:66, 180:186] = 0
    centre = Pose2(2.5, 2.1, 0.0)
    assert find_difference(Grid(values, 0.05, Pose2(0.0, 0.0, 0.0)), centre, centre) is None


def test_places_are_described_with_what_tells_the_first_two_apart() -> None:
    places = [Pose2(2.5, 2.0, 0.0), Pose2(7.5, 2.0, 0.0)]
    assert describe_poses(two_rooms(), places, "wait") == (
        "2 places on the map fit: (2.50, 2.00), (7.50, 2.00); "
        "the first two differ 1.8 m ahead to the left of the robot: drive there"
    )


def test_places_that_look_alike_everywhere_are_described_with_another_advice() -> None:
    grid = Grid(np.zeros((100, 100), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    described = describe_poses(grid, [Pose2(2.5, 2.5, 0.1 * number) for number in range(6)], "drive on")
    assert described.startswith("6 places on the map fit: ")
    assert described.count("(2.50, 2.50)") == 4
    assert described.endswith("; the map is the same round the first two: drive on")
