from __future__ import annotations

import math

import numpy as np
import pytest

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.ambiguity import find_difference, find_places, name_direction
from ur_nodes.localisation.particle_filter import Particles


def two_rooms() -> Grid:
    """Two rooms of 5 m x 4 m side by side that look alike, but for a pillar in the north-east of the second one."""
    values = np.zeros((84, 204), dtype=np.int8)
    values[:2] = values[-2:] = 100
    values[:, :2] = values[:, 101:103] = values[:, -2:] = 100
    values[60:66, 180:186] = 100
    return Grid(values, 0.05, Pose2(0.0, 0.0, 0.0))


def heap(pose: tuple[float, float, float], count: int) -> np.ndarray:
    return np.array(pose) + np.random.default_rng(0).normal(0.0, 0.05, (count, 3))


def test_heaps_of_particles_are_places_the_heaviest_first() -> None:
    poses = np.vstack((heap((1.0, 2.0, 3.0), 50), heap((6.0, 2.0, 3.0), 80), heap((9.0, 1.0, 0.0), 3)))
    places = find_places(Particles(poses, np.full(len(poses), 1.0 / len(poses))))
    assert [round(place.pose.x) for place in places] == [6, 1]
    assert places[0].share == pytest.approx(80 / 133)


def test_one_heap_is_one_place_whatever_its_heading() -> None:
    places = find_places(Particles(heap((1.0, 2.0, math.pi), 50), np.full(50, 0.02)))
    assert len(places) == 1


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
