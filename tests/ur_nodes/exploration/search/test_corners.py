import numpy as np

from ur_nodes.exploration.search.choice import CornerSettings, sort_corners
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.search.viewpoints import Viewpoint
from ur_nodes.geometry.pose import Pose2

SETTINGS = CornerSettings(area=0.3, left_out=0.02)


def view(gain: float, x: float = 0.0, distance: float = 1.0, hidden: frozenset[int] = frozenset()) -> Viewpoint:
    cell = np.array([0, 0])
    frontier = Frontier(np.array([cell] * 10), cell, (x, 0.0), 0.5, gain, hidden)
    return Viewpoint(Pose2(x, 0.0, 0.0), (0, 0), distance, frontier)


def test_corners_come_after_rooms() -> None:
    room, corner = view(2.0), view(0.25)
    places = sort_corners((corner, room), 10.0, SETTINGS)
    assert places.now == (room,)
    assert places.later == (corner,)
    assert sort_corners((corner,), 10.0, SETTINGS).now == (corner,)


def test_doorway_is_no_corner_however_large_the_map_is() -> None:
    doorway = view(0.75**2)  # its gain is its width squared at most
    assert sort_corners((doorway, view(0.05)), 400.0, CornerSettings()).now == (doorway,)


def test_room_is_not_left_out_however_large_the_map_is() -> None:
    room, corner = view(0.31), view(0.25)
    assert sort_corners((corner, room), 1000.0, SETTINGS).ahead == (room,)


def test_smallest_corners_are_left_out_as_far_as_they_hide_little() -> None:
    corners = [view(gain) for gain in (0.2, 0.1, 0.15, 0.25)]
    places = sort_corners(corners, 23.0, SETTINGS)
    assert places.left_out == (corners[1], corners[2], corners[0])
    assert places.ahead == (corners[3],)


def test_corner_that_is_near_is_visited_rather_than_one_that_is_far() -> None:
    near, far = view(0.2, distance=0.5), view(0.25, distance=8.0)
    assert sort_corners((near, far), 20.0, SETTINGS).ahead == (near,)


def test_what_two_corners_hide_together_counts_once() -> None:
    sides = [view(0.2, hidden=frozenset(range(80))), view(0.22, hidden=frozenset(range(90)))]
    assert sort_corners(sides, 15.0, SETTINGS).ahead == ()
    apart = [view(0.2, hidden=frozenset(range(80))), view(0.22, hidden=frozenset(range(80, 170)))]
    assert sort_corners(apart, 15.0, SETTINGS).ahead == (apart[1],)


def test_corner_beside_the_robot_comes_before_rooms() -> None:
    room, beside, away = view(2.0), view(0.25, distance=0.5), view(0.25, distance=4.0)
    places = sort_corners((room, beside, away), 1.0, SETTINGS)
    assert (places.now, places.later) == ((room, beside), (away,))


def test_no_corner_is_left_out_when_all_are_asked_for() -> None:
    corner = view(0.01)
    assert sort_corners((corner,), 100.0, CornerSettings(left_out=0.0)).now == (corner,)


def test_frontier_that_is_driven_to_becomes_a_corner_later() -> None:
    here, there = view(0.2), view(0.2, 5.0)
    places = sort_corners((here, there), 60.0, SETTINGS, kept=(0.3, 0.0))
    assert places.now == (here,)
    assert places.left_out == (there,)


def test_frontier_that_is_driven_to_becomes_no_corner_once_nothing_is_found_on_the_way() -> None:
    here, there = view(0.1), view(0.9, 5.0)
    assert here not in sort_corners((here, there), 150.0, SETTINGS, kept=(0.3, 0.0)).now
    assert sort_corners((here, there), 150.0, SETTINGS, kept=(0.3, 0.0), idle_distance=4.0).now == (here, there)
