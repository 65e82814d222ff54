import math

import numpy as np
from tests.ur_nodes.slam.drives import MOVED_SOFA, SOFA, WALLS, distances, drive, feed
from tests.ur_nodes.slam.rooms import Floats, box, walls_of

from ur_nodes.geometry.grid import OCCUPIED
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.map_state import MapState, find_drives
from ur_nodes.slam.merge import Merged, NotMerged, merge_maps
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker

SHELL = np.vstack((walls_of(box(-3.0, -2.0, 9.0, 3.0)), WALLS[12:]))  # the two rooms without furniture
SOFAS = ((2.05, -1.55), (-0.05, -1.55))  # the middle before it was moved, and after
ELSEWHERE = walls_of(box(0.0, 0.0, 5.0, 4.0), box(1.5, 1.0, 2.5, 1.5), box(3.5, 2.6, 3.9, 4.0))


def map_of(walls: Floats, poses: list[Pose2], seed: int) -> MapState:
    tracker = MapTracker()
    feed(tracker, walls, poses, Pose2(0.0, 0.0, 0.0), seed)
    return MapState(tracker.keyframes, tracker.edges, tracker.scans, tracker.drives())


def test_maps_that_overlap_become_one_in_the_frame_of_the_first() -> None:
    first, second = drive(-2.0, 4.2), drive(7.8, 1.8)
    walls = np.vstack((WALLS, MOVED_SOFA))
    one, other = map_of(np.vstack((WALLS, SOFA)), first, 0), map_of(walls, second, 1000)
    merged = merge_maps(one, other)
    assert isinstance(merged, Merged)
    state = merged.state
    assert len(state.poses) == len(state.scans) == len(one.poses) + len(other.poses)
    assert state.drives == (len(one.poses),) == tuple(find_drives(state.edges, len(state.poses)))
    true = first[0].inverse().compose(second[0])
    assert math.dist(merged.pose[:2], true[:2]) < 0.05
    assert abs(merged.pose.yaw - true.yaw) < 0.02
    assert [min(math.dist(first[0].transform_points(np.array((each.x, each.y))), sofa) for sofa in SOFAS) < 0.6
            for each in merged.changes] == [True, True]  # fmt: skip
    drawn = OccupancyMap()
    drawn.update(state.poses, state.scans, state.drives)
    grid = drawn.grid()
    cells = grid.points_of_cells(np.argwhere(grid.values == OCCUPIED))
    places = first[0].transform_points(cells)
    assert np.mean(distances(places, walls) < 0.1) > 0.99  # no wall is double, and the sofa is where it was seen last


def test_maps_between_which_all_furniture_was_moved_are_merged() -> None:
    places = ((-2.7, 2.2), (-0.6, 2.2), (2.4, 2.2), (4.3, 2.2), (4.4, -1.9), (6.6, -1.9), (8.2, -1.9), (2.6, -1.9))
    before, after = (
        np.vstack((SHELL, *(walls_of(box(x, y, x + 0.9, y + 0.7)) for x, y in places[first::2]))) for first in (0, 1)
    )
    one, other = map_of(before, drive(-2.0, 7.5, 0.2), 0), map_of(after, drive(7.6, -1.8, 0.2), 1000)
    merged = merge_maps(one, other)
    assert isinstance(merged, Merged)
    assert len(merged.changes) >= len(places)


def test_maps_of_different_places_are_not_merged() -> None:
    one = map_of(WALLS, drive(-2.0, 2.0), 0)
    other = map_of(ELSEWHERE, [Pose2(0.5 + 0.1 * n, 0.5 + 0.01 * n, 0.1 * n) for n in range(30)], 1000)
    assert isinstance(merge_maps(one, other), NotMerged)


def test_maps_that_fit_in_two_ways_are_not_merged() -> None:
    walls = walls_of(box(-3.0, -1.5, 3.0, 1.5))
    one, other = (map_of(walls, [Pose2(0.1 * n, 0.2, 0.0) for n in range(20)], seed) for seed in (0, 1000))
    result = merge_maps(one, other)
    assert isinstance(result, NotMerged)
    assert result.reason == "several-places"
    assert len(result.poses) == 2


def test_map_without_scans_is_not_merged() -> None:
    one = map_of(WALLS, drive(-2.0, 0.0), 0)
    assert merge_maps(one, MapState((), (), ())) == NotMerged("no-scans")
