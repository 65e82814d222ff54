"""Tracks of people in scans of a round person, from a sensor at the origin."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.navigation.people.tracked_people import TrackedPeople
from ur_nodes.navigation.people.tracker import PeopleTracker

SENSOR = (0.0, 0.0)
PERIOD = 0.1  # s


def arc(x: float, y: float, radius: float = 0.2, noise: float = 0.0) -> np.ndarray:
    """The points (n, 2) of a scan that end on a round body, a degree apart."""
    distance, bearing = math.hypot(x, y), math.atan2(y, x)
    half = math.floor(math.degrees(math.asin(radius / distance)))
    offsets = np.radians(np.arange(-half, half + 1))
    ranges = distance * np.cos(offsets) - np.sqrt(radius**2 - (distance * np.sin(offsets)) ** 2)
    ranges = ranges + noise * np.random.default_rng(round(1000 * x)).standard_normal(len(ranges))
    angles = bearing + offsets
    return np.asarray(ranges[:, None] * np.column_stack((np.cos(angles), np.sin(angles))))


def track(*places: tuple[float, float], noise: float = 0.0, explained: bool = False) -> TrackedPeople:
    """The people after scans of one body at places."""
    tracker = PeopleTracker()
    for number, place in enumerate(places):
        points = arc(*place, noise=noise)
        tracker.update(number * PERIOD, SENSOR, points, np.full(len(points), explained))
    return tracker.people((len(places) - 1) * PERIOD)


@settings(max_examples=30)
@given(st.floats(0.4, 1.2), st.floats(-math.pi, math.pi))
def test_one_who_walks_is_found_with_place_and_velocity(speed: float, course: float) -> None:
    step = PERIOD * speed * np.array((math.cos(course), math.sin(course)))
    places = [(2.5 + i * step[0], 0.5 + i * step[1]) for i in range(16)]
    people = track(*places, noise=0.01)
    assert len(people.points) == 1
    assert math.dist(people.points[0], places[-1]) < 0.12
    assert np.hypot(*(people.velocities[0] - step / PERIOD)) < 0.25


def test_one_who_stands_counts_as_a_person_at_first_only() -> None:
    assert len(track(*[(2.0, 0.0)] * 20).points) == 1
    assert np.all(track(*[(2.0, 0.0)] * 20).velocities == 0.0)
    assert len(track(*[(2.0, 0.0)] * 310).points) == 0


def test_one_who_walked_and_stands_stays_a_person() -> None:
    walk = [(2.0 + 0.08 * i, 0.0) for i in range(15)]
    people = track(*walk, *[walk[-1]] * 130)
    assert len(people.points) == 1
    assert np.hypot(*people.velocities[0]) < 0.05


def test_what_the_map_explains_and_what_is_wider_is_no_person() -> None:
    assert len(track((2.0, 0.0), explained=True).points) == 0
    wall = np.column_stack((np.full(60, 2.0), np.linspace(-1.0, 1.0, 60)))
    tracker = PeopleTracker()
    tracker.update(0.0, SENSOR, wall, np.zeros(60, bool))
    assert len(tracker.people(0.0).points) == 0


def test_two_who_cross_keep_their_tracks() -> None:
    tracker = PeopleTracker()
    for i in range(20):
        points = np.concatenate((arc(2.0, -1.0 + 0.1 * i), arc(3.5, 1.0 - 0.1 * i)))
        tracker.update(i * PERIOD, SENSOR, points, np.zeros(len(points), bool))
    people = tracker.people(1.9)
    assert sorted(np.sign(people.velocities[:, 1]).tolist()) == [-1.0, 1.0]


def test_points_of_walkers_are_marked() -> None:
    tracker = PeopleTracker()
    for i in range(12):
        points = np.concatenate((arc(2.0 + 0.08 * i, 0.0), arc(0.0, 2.0)))
        tracker.update(i * PERIOD, SENSOR, points, np.zeros(len(points), bool))
    marked = tracker.are_walkers(points)
    assert marked[: len(arc(2.88, 0.0))].all()
    assert not marked[-len(arc(0.0, 2.0)) :].any()


def test_a_long_pause_and_forgetting_end_all_tracks() -> None:
    tracker = PeopleTracker()
    points = arc(2.0, 0.0)
    tracker.update(0.0, SENSOR, points, np.zeros(len(points), bool))
    tracker.forget()
    assert len(tracker.people(0.0).points) == 0
    tracker.update(0.0, SENSOR, points, np.zeros(len(points), bool))
    tracker.update(5.0, SENSOR, np.empty((0, 2)), np.zeros(0, bool))
    assert len(tracker.people(5.0).points) == pytest.approx(0)
