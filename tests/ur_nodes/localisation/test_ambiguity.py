import math

import numpy as np
import pytest

from ur_nodes.localisation.localiser import find_clusters
from ur_nodes.localisation.particle_filter import Particles


def heap(pose: tuple[float, float, float], count: int) -> np.ndarray:
    return np.array(pose) + np.random.default_rng(0).normal(0.0, 0.05, (count, 3))


def test_heaps_of_particles_are_places_the_heaviest_first() -> None:
    poses = np.vstack((heap((1.0, 2.0, 3.0), 50), heap((6.0, 2.0, 3.0), 80), heap((9.0, 1.0, 0.0), 3)))
    places = find_clusters(Particles(poses, np.full(len(poses), 1.0 / len(poses))))
    assert [round(place.pose.x) for place in places] == [6, 1]
    assert places[0].share == pytest.approx(80 / 133)


def test_one_heap_is_one_place_whatever_its_heading() -> None:
    places = find_clusters(Particles(heap((1.0, 2.0, math.pi), 50), np.full(50, 0.02)))
    assert len(places) == 1
