"""A robot in one of two rooms that differ by a box only, on a map of both."""

import math
from itertools import pairwise

import numpy as np
import pytest
from tests.ur_nodes.slam.drives import feed
from tests.ur_nodes.slam.rooms import Floats, box, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.tracker import MapTracker

WIDTH = 4.0  # m, of a room
TABLE, BOX = box(2.6, 1.3, 3.1, 2.1), box(3.4, 2.7, 3.8, 3.1)
INSIDE = ((1.0, 1.0), (1.0, 2.2), (2.2, 2.4), (2.2, 0.7), (3.4, 0.7), (3.4, 2.2), (2.2, 2.4))
SECOND = 5  # scans, at 0.3 m/s


def room_at(left: float, *things: tuple[tuple[float, float], ...]) -> Floats:
    """A room with a door to the hall below it, a bed, and other things."""
    walls = np.array([
        ((0.0, 0.0), (1.2, 0.0)), ((2.1, 0.0), (WIDTH, 0.0)), ((0.0, 0.0), (0.0, 3.4)), ((WIDTH, 0.0), (WIDTH, 3.4)),
        ((0.0, 3.4), (WIDTH, 3.4)),
    ])  # fmt: skip
    inside = walls_of(box(0.0, 2.8, 1.4, 3.4), *things)
    room: Floats = np.concatenate((walls, inside)) + np.array((left, 0.0))
    return room


HALL = np.array([((0.0, 0.0), (0.0, -1.8)), ((0.0, -1.8), (8.0, -1.8)), ((8.0, -1.8), (8.0, 0.0))])
WALLS = np.concatenate((room_at(0.0, TABLE), room_at(WIDTH, TABLE, BOX), HALL))


def along(corners: list[tuple[float, float]], step: float) -> list[Pose2]:
    """The poses of a drive along straight lines, `step` m apart, with turns on the spot between them."""
    poses: list[Pose2] = []
    for begin, end in pairwise(corners):
        bearing = math.atan2(end[1] - begin[1], end[0] - begin[0])
        turn = wrap_angle(bearing - poses[-1].yaw) if poses else 0.0
        count = math.ceil(abs(turn) / (2.0 * step))
        poses += [Pose2(*begin, wrap_angle(bearing - turn + turn * each / count)) for each in range(1, count + 1)]
        places = np.linspace(begin, end, max(2, round(math.dist(begin, end) / step)))
        poses += [Pose2(x, y, bearing) for x, y in places.tolist()]
    return poses


@pytest.fixture(scope="module")
def made() -> tuple[MapTracker, Pose2]:
    """A map of both rooms, and its frame."""
    tracker = MapTracker()
    corners = [(0.6, -0.9)]
    for left in (0.0, WIDTH):
        door = [(left + 1.65, -0.9), (left + 1.65, 0.6)]
        corners += [*door, *((left + x, y) for x, y in INSIDE), *reversed(door)]
    path = along(corners, 0.15)
    feed(tracker, WALLS, path, Pose2(0.0, 0.0, 0.0))
    return tracker, path[0]


@pytest.mark.parametrize("left", [0.0, WIDTH])
def test_small_difference_tells_twin_rooms_apart_within_20_s(made: tuple[MapTracker, Pose2], left: float) -> None:
    before, frame = made
    tracker = MapTracker()
    tracker.restore(before.keyframes, before.edges, before.scans)
    inside = [(left + x, y) for x, y in INSIDE]
    for number, pose in enumerate(along(inside + inside[::-1], 0.06)[: 20 * SECOND]):
        estimate = tracker.add_scan(scan_at(WALLS, pose, 0.01, 5000 + number), Pose2(3.0, 1.0, 0.7).compose(pose))
        if not tracker.lost:
            break
    assert not tracker.lost
    assert math.dist(estimate.pose[:2], frame.inverse().compose(pose)[:2]) < 0.05
