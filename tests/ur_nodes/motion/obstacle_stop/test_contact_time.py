"""The outline swept along an arc, compared with small steps of the same arc."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.obstacle_stop.guard import time_to_contact

MAGNI = ((0.13, 0.205), (-0.28, 0.205), (-0.28, -0.205), (0.13, -0.205))
HULL = hull_of_outline(MAGNI)


def walk(points: np.ndarray, margin: float, velocity: tuple[float, float], horizon: float, left: float = 0.0) -> float:
    """The time of the first contact by steps of 1 ms; infinite for none."""
    forward, turn = velocity
    for number in range(round(horizon * 1000)):
        seconds = number / 1000.0
        angle = turn * seconds
        if abs(turn) > 1e-9:
            ahead, aside = math.sin(angle) / turn, (1.0 - math.cos(angle)) / turn
            place = Pose2(forward * ahead - left * aside, forward * aside + left * ahead, angle)
        else:
            place = Pose2(forward * seconds, left * seconds, 0.0)
        if (HULL.distances(place.inverse().transform_points(points)) <= margin).any():
            return seconds
    return math.inf


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=8),
    st.floats(-0.5, 0.5),
    st.sampled_from((0.0, 0.3, -0.3, 1.0, -1.0)),
    st.sampled_from((0.0, 0.4, -0.2)),
)
def test_time_to_contact_is_that_of_small_steps(
    places: list[tuple[float, float]], forward: float, turn: float, left: float
) -> None:
    points = np.array(places)
    points = points[HULL.distances(points) > 0.04]
    time, first = time_to_contact(HULL, points, 0.03, (forward, turn), 2.0, left)
    stepped = walk(points, 0.03, (forward, turn), 2.0, left)
    if math.isinf(stepped):
        assert time > 1.99 or _grazes(points, (forward, turn), time, left)
    else:
        assert time == pytest.approx(stepped, abs=0.0025)
        assert 0 <= first < len(points)


def _grazes(points: np.ndarray, velocity: tuple[float, float], time: float, left: float) -> bool:
    """Return whether the contact is so shallow that steps of 1 ms miss it."""
    return math.isfinite(walk(points, 0.031, velocity, time + 0.01, left))


@pytest.mark.parametrize(
    ("point", "velocity", "meets"),
    [
        ((0.14, 0.0), (0.5, 0.0), True),  # 1 cm ahead
        ((0.14, 0.0), (-0.5, 0.0), False),
        ((0.12, 0.0), (-0.5, 0.0), False),  # 1 cm inside: out of it again
        ((0.12, 0.0), (0.5, 0.0), True),
        ((-0.29, 0.0), (0.5, 0.0), False),
        ((-0.29, 0.0), (-0.5, 0.0), True),
        ((0.0, 0.215), (0.5, 0.0), False),  # along a wall that is nearer than the margin
        ((0.0, 0.215), (-0.5, 0.0), False),
        ((0.1, 0.215), (0.0, 1.0), True),  # the front corner swings towards it
        ((0.1, 0.215), (0.0, -1.0), False),
    ],
)
def test_motion_away_from_what_is_near_is_free_and_towards_it_is_not(
    point: tuple[float, float], velocity: tuple[float, float], meets: bool
) -> None:
    time, _ = time_to_contact(HULL, np.array([point]), 0.03, velocity, 0.3)
    assert (time < 0.02) is meets


def test_hull_of_a_notched_outline_covers_the_notch() -> None:
    hull = hull_of_outline(((0.1, 0.1), (0.0, 0.05), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)))
    assert len(hull.corners) == 4
    assert hull.distances(np.array([(0.0, 0.09), (0.0, 0.12), (0.15, 0.0)])) == pytest.approx([-0.01, 0.02, 0.05])


def test_points_of_the_outline_lie_on_it_and_in_the_directions_asked_for() -> None:
    points = HULL.edge_points(-0.5, 0.5)
    assert len(points) > 5
    assert HULL.distances(points) == pytest.approx(np.zeros(len(points)), abs=1e-9)
    assert (np.abs(np.arctan2(points[:, 1], points[:, 0])) <= 0.5).all()
