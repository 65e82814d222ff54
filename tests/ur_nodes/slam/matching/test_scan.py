import math

import numpy as np
from tests.ur_nodes.slam.drives import SOFA, WALLS, drive
from tests.ur_nodes.slam.rooms import DIRECTIONS, Floats, ranges_at

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.slam.matching.scan import MapScan, join_scans, make_scan
from ur_nodes.slam.tracker import MapTracker

ROOMS = np.vstack((WALLS, SOFA))
AHEAD = DIRECTIONS[:, 0] >= 0.0
MOUNTS = Pose2(0.2, 0.0, 0.0), Pose2(-0.2, 0.0, math.pi)


def half(walls: Floats, robot: Pose2, mount: Pose2, seed: int) -> MapScan:
    """The scan of a lidar that sees 180 degrees and is mounted so on a robot."""
    ranges = ranges_at(walls, robot.compose(mount), 0.01, seed)[AHEAD]
    c, s = math.cos(mount.yaw), math.sin(mount.yaw)
    return make_scan(
        ranges, DIRECTIONS[AHEAD], (0.1, 12.0), SensorMount(np.array(((c, -s), (s, c))), np.array(mount[:2]))
    )


def test_joined_scan_has_the_beams_of_all_lidars_and_those_of_two_are_no_neighbours() -> None:
    pose = Pose2(0.0, 0.0, 0.3)
    parts = [half(ROOMS, pose, mount, 1) for mount in MOUNTS]
    whole = join_scans(parts)
    assert len(whole.hits) == sum(len(each.hits) for each in parts)
    assert np.all(np.diff(whole.numbers.astype(int)) > 0)
    assert np.diff(whole.numbers.astype(int)).max() >= 100
    assert whole.origin.tolist() == [0.0, 0.0]
    assert join_scans(parts[:1]) is parts[0]


def test_rooms_are_mapped_with_two_lidars_that_see_half_each() -> None:
    path = drive(-2.0, 6.5, 0.15)
    tracker, worst = MapTracker(), 0.0
    for number, pose in enumerate(path):
        scan = join_scans([half(ROOMS, pose, mount, 2 * number + side) for side, mount in enumerate(MOUNTS)])
        estimate = tracker.add_scan(scan, pose)
        true = path[0].inverse().compose(pose)
        worst = max(worst, math.hypot(estimate.pose.x - true.x, estimate.pose.y - true.y))
        assert not tracker.lost
    assert worst < 0.03
