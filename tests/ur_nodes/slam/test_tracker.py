import math

import numpy as np
import pytest
from tests.ur_nodes.slam.drives import MOVED_SOFA, SOFA, WALLS, distances, drive, feed
from tests.ur_nodes.slam.rooms import box, scan_at, walls_of

from ur_nodes.geometry.grid import OCCUPIED
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.mapper import MapEstimate
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker


def error(estimate: MapEstimate, pose: Pose2, first: Pose2) -> float:
    true = first.inverse().compose(pose)
    return math.hypot(estimate.pose.x - true.x, estimate.pose.y - true.y)


@pytest.fixture(scope="module")
def made() -> tuple[MapTracker, list[Pose2]]:
    """A map of both rooms, and the path on which it was made."""
    tracker, poses = MapTracker(), drive(-2.0, 8.0)
    feed(tracker, np.vstack((WALLS, SOFA)), poses, Pose2(0.0, 0.0, 0.0))
    assert not tracker.lost
    return tracker, poses


def test_stored_map_is_continued_from_another_place(made: tuple[MapTracker, list[Pose2]]) -> None:
    before, path = made
    tracker = MapTracker()
    tracker.restore(before.keyframes, before.edges, before.scans)
    assert tracker.lost
    poses = drive(3.0, -2.0)
    walls = np.vstack((WALLS, MOVED_SOFA))
    estimates = feed(tracker, walls, poses, Pose2(5.0, 1.0, 2.0), seed=1000)
    known = [number for number, each in enumerate(estimates) if each.located]
    assert known[0] < 12
    assert known == list(range(known[0], len(poses)))
    assert max(error(estimates[number], poses[number], path[0]) for number in known) < 0.05
    assert len(tracker.scans) > len(before.scans) + 5
    assert tracker.drives() == [len(before.scans)]

    drawn = OccupancyMap()
    drawn.update(tracker.keyframes, tracker.scans, tracker.drives())
    grid = drawn.grid()
    rows, columns = np.nonzero(grid.values == OCCUPIED)
    cells = (np.column_stack((columns, rows)) + 0.5) * grid.resolution + (grid.origin.x, grid.origin.y)
    places = path[0].transform_points(cells)
    assert np.mean(distances(places, walls) < 0.1) > 0.99  # no wall is double, and the sofa is where it was seen last
    assert np.sum(distances(places, MOVED_SOFA) < 0.05) > 15


def test_robot_that_is_carried_to_the_other_room_is_found_again(made: tuple[MapTracker, list[Pose2]]) -> None:
    path = made[1]
    tracker = MapTracker()
    walls = np.vstack((WALLS, SOFA))
    feed(tracker, walls, path, Pose2(0.0, 0.0, 0.0))
    poses = drive(-1.5, 2.5)
    estimates = feed(tracker, walls, poses, path[-1].compose(poses[0].inverse()), seed=1000)
    lost = [number for number, each in enumerate(estimates) if not each.located]
    assert lost
    assert lost[0] < 8
    assert not tracker.lost
    assert lost[-1] < len(poses) - 5
    assert error(estimates[-1], poses[-1], path[0]) < 0.05
    for pose, scan in zip(tracker.keyframes, tracker.scans, strict=True):
        seen = path[0].compose(pose).transform_points(scan.hits.astype(np.float64))
        assert np.mean(distances(seen, walls) < 0.1) > 0.95  # no keyframe lies where the robot only seemed to be


def test_robot_that_is_carried_to_a_room_that_is_not_mapped_adds_it_once_it_drives_back() -> None:
    path = drive(-2.0, 1.5)
    tracker = MapTracker()
    walls = np.vstack((WALLS, SOFA))
    feed(tracker, walls, path, Pose2(0.0, 0.0, 0.0))
    poses = drive(8.0, -1.5)
    estimates = feed(tracker, walls, poses, path[-1].compose(poses[0].inverse()), seed=1000)
    lost = [number for number, each in enumerate(estimates) if not each.located]
    assert lost[0] < 8
    assert poses[lost[-1]].x < 6.0  # as long as it sees nothing that is mapped, it is taken to be nowhere
    assert not tracker.lost
    assert error(estimates[-1], poses[-1], path[0]) < 0.05
    places = [path[0].compose(pose) for pose in tracker.keyframes]
    assert sum(place.x > 5.0 for place in places) > 3
    for place, scan in zip(places, tracker.scans, strict=True):
        seen = place.transform_points(scan.hits.astype(np.float64))
        assert np.mean(distances(seen, walls) < 0.1) > 0.95


def test_robot_in_a_room_that_looks_the_same_from_both_ends_stays_lost() -> None:
    walls = walls_of(box(-3.0, -1.5, 3.0, 1.5))
    poses = [Pose2(0.1 * n, 0.2, 0.0) for n in range(12)]
    before = MapTracker()
    feed(before, walls, poses, Pose2(0.0, 0.0, 0.0))
    tracker = MapTracker()
    tracker.restore(before.keyframes, before.edges, before.scans)
    feed(tracker, walls, poses, Pose2(0.0, 0.0, 0.0), seed=1000)
    assert tracker.lost
    assert len(tracker.candidates()) == 2
    assert len(tracker.scans) == len(before.scans)


def test_robot_that_drives_through_a_sliding_door_onto_floor_that_is_not_mapped_is_not_lost() -> None:
    """Through the open door it sees nothing that it knows, and through the wall that the door was."""
    around = walls_of(box(-3.0, -1.0, 0.0, 1.0), box(0.0, -5.0, 8.0, 3.0), box(4.0, -1.0, 4.5, 0.5))
    around = np.array([wall for wall in around if np.any(wall[:, 0] != 0.0)])
    beside = [((0.0, -5.0), (0.0, -1.0)), ((0.0, 1.0), (0.0, 3.0))]
    tracker, path = MapTracker(), []
    for number in range(45):
        opened = min(2.0, 0.2 * max(0, number - 15))
        pose = Pose2(-1.8 + 0.1 * min(number, 10) + 0.1 * max(0, number - 22), 0.0, 0.0)
        path.append(pose)
        door = [((0.0, -1.0 + opened), (0.0, 1.0))] if opened < 2.0 else []
        scan = scan_at(np.vstack((around, [*beside, *door])), pose, 0.01, number, view=2.0)
        # The wheels turn a little on the spot, so that no scan is one at rest.
        turned = Pose2(pose.x, pose.y, 0.01 * (number % 2))
        estimate = tracker.add_scan(scan, turned)
        assert not tracker.lost
    assert error(estimate, path[-1], path[0]) < 0.05
