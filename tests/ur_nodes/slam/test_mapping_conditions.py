"""Maps that are made among people, doors and glass, with wheels that slip, and with lidars that see little."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from tests.ur_nodes.slam.drives import SOFA, WALLS, distances, drive
from tests.ur_nodes.slam.rooms import CENTRE, DIRECTIONS, RANGE, Floats, box, ranges_at, scan_at, walls_of

from ur_nodes.geometry.grid import OCCUPIED
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan, make_scan
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker

ROOMS = np.vstack((WALLS, SOFA))
CLOSED_DOOR = np.array([((4.0, -0.5), (4.0, 0.6))])
PANE = np.array([((-3.0, -1.2), (-3.0, 1.0))])  # a part of the wall in the west
PATH = [*drive(-2.0, 6.5, 0.15), *drive(6.5, 1.0, 0.15)]


def run(
    poses: Sequence[Pose2], see: Callable[[int, Pose2], MapScan], odometry: Sequence[Pose2] | None
) -> tuple[MapTracker, float, int]:
    """Map what is seen on a path: the tracker, the worst live error (m), and how often the robot counted as lost."""
    tracker, worst, lost = MapTracker(), 0.0, 0
    for number, pose in enumerate(poses):
        estimate = tracker.add_scan(see(number, pose), odometry[number] if odometry else None)
        true = poses[0].inverse().compose(pose)
        worst = max(worst, math.hypot(estimate.pose.x - true.x, estimate.pose.y - true.y))
        lost += tracker.lost
    return tracker, worst, lost


def draw(tracker: MapTracker, first: Pose2) -> Floats:
    """The centres (n, 2) of the occupied cells of the map, in the frame of the rooms."""
    drawn = OccupancyMap()
    drawn.update(tracker.keyframes, tracker.scans, tracker.drives())
    grid = drawn.grid()
    cells = grid.points_of_cells(np.argwhere(grid.values == OCCUPIED))
    return first.transform_points(cells)


@pytest.mark.parametrize(
    ("degrees", "reach", "most"),
    [
        (180, RANGE, 0.05),
        (270, RANGE, 0.03),
        (360, 4.0, 0.05),
    ],
)
def test_rooms_are_mapped_with_little_sight(degrees: float, reach: float, most: float) -> None:
    view = math.radians(degrees)
    tracker, worst, lost = run(PATH, lambda n, pose: scan_at(ROOMS, pose, 0.01, n, view, reach), PATH)
    assert lost == 0
    assert worst < most
    assert np.mean(distances(draw(tracker, PATH[0]), ROOMS) < 0.1) > 0.99


def test_rooms_are_mapped_with_a_lidar_of_5_hz_on_a_fast_robot() -> None:
    path = [*drive(-2.0, 6.5, 0.2), *drive(6.5, 1.0, 0.2)]  # 1 m/s
    _, worst, lost = run(path, lambda n, pose: scan_at(ROOMS, pose, 0.01, n), path)
    assert lost == 0
    assert worst < 0.03


def test_rooms_are_mapped_without_odometry() -> None:
    path = drive(-2.0, 6.5, 0.08)
    tracker, worst, lost = run(path, lambda n, pose: scan_at(ROOMS, pose, 0.01, n), None)
    assert lost == 0
    assert worst < 0.05
    assert np.mean(distances(draw(tracker, path[0]), ROOMS) < 0.1) > 0.99


def test_door_that_closes_behind_the_robot_breaks_nothing() -> None:
    closed = np.vstack((ROOMS, CLOSED_DOOR))
    path = [*PATH, *drive(1.0, 3.4, 0.15), *drive(3.4, -1.0, 0.15)]
    tracker, worst, lost = run(path, lambda n, pose: scan_at(ROOMS if n < len(PATH) else closed, pose, 0.01, n), path)
    assert lost == 0
    assert worst < 0.05
    assert np.mean(distances(draw(tracker, path[0]), closed) < 0.1) > 0.99


def test_people_who_walk_about_are_no_walls() -> None:
    def see(number: int, pose: Pose2) -> MapScan:
        people = []
        for person, (x, y) in enumerate(((-1.0, -1.2), (2.0, 2.4), (6.0, -1.3))):
            x, y = x + 0.9 * math.sin(0.21 * number + person), y + 0.3 * math.cos(0.17 * number + 2.0 * person)
            people.append(box(x - 0.15, y - 0.15, x + 0.15, y + 0.15))
        return scan_at(np.vstack((ROOMS, walls_of(*people))), pose, 0.01, number)

    tracker, worst, lost = run(PATH, see, PATH)
    assert lost == 0
    assert worst < 0.04
    assert np.mean(distances(draw(tracker, PATH[0]), ROOMS) < 0.1) > 0.96


def test_wall_of_glass_spoils_no_other_wall() -> None:
    """A beam sees glass only where it meets it almost at a right angle, and else what is behind: here nothing."""
    behind = walls_of(box(-6.0, -2.5, -3.05, 2.5))

    def see(number: int, pose: Pose2) -> MapScan:
        whole = ranges_at(ROOMS, pose, 0.01, number)
        turn = np.array(((math.cos(pose.yaw), math.sin(pose.yaw)), (-math.sin(pose.yaw), math.cos(pose.yaw))))
        beams = DIRECTIONS @ turn
        ends = np.where(np.isfinite(whole), whole, 0.0)[:, None] * beams + (pose.x, pose.y)
        through = (distances(ends, PANE) < 0.1) & (np.abs(beams[:, 0]) < math.cos(0.15))
        return make_scan(np.where(through, ranges_at(behind[1:], pose), whole), DIRECTIONS, (0.1, RANGE), CENTRE)

    path = [*drive(6.5, -2.0, 0.15), *drive(-2.0, 1.0, 0.15)]
    tracker, worst, lost = run(path, see, path)
    assert lost == 0
    assert worst < 0.04
    assert np.mean(distances(draw(tracker, path[0]), np.vstack((ROOMS, behind))) < 0.1) > 0.99


def test_wheels_that_slip_on_a_carpet_bend_no_wall() -> None:
    odometry = [PATH[0]]
    for number, (before, after) in enumerate(pairwise(PATH)):
        step = before.inverse().compose(after)
        slips = number % 40 in range(10, 18)  # the wheels turn twice as far as the robot drives, one of them more
        odometry.append(odometry[-1].compose(Pose2(2.0 * step.x, 2.0 * step.y, step.yaw + 0.06) if slips else step))
    tracker, worst, lost = run(PATH, lambda n, pose: scan_at(ROOMS, pose, 0.01, n), odometry)
    assert math.dist(odometry[-1][:2], PATH[-1][:2]) > 0.5
    assert lost == 0
    assert worst < 0.05
    assert np.mean(distances(draw(tracker, PATH[0]), ROOMS) < 0.1) > 0.99
