"""Two rooms that differ, with a doorway between them, and drives through them."""

import math
from collections.abc import Sequence

import numpy as np
from tests.ur_nodes.slam.rooms import Floats, box, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.mapper import MapEstimate
from ur_nodes.slam.tracker import MapTracker

WALLS = np.vstack((
    walls_of(box(-3.0, -2.0, 9.0, 3.0), box(0.0, 1.2, 1.8, 1.6), box(-2.0, -1.4, -1.5, -0.8)),
    [((4.0, -2.0), (4.0, -0.5)), ((4.0, 0.6), (4.0, 3.0)), ((6.0, 3.0), (7.5, 1.5)), ((7.5, 1.5), (9.0, 1.5))],
))  # fmt: skip
SOFA = walls_of(box(1.5, -1.9, 2.6, -1.2))
MOVED_SOFA = walls_of(box(-0.6, -1.9, 0.5, -1.2))


def drive(first: float, last: float, step: float = 0.12) -> list[Pose2]:
    """A path along the two rooms, in steps of `step` m; to smaller x it is driven backwards."""
    count = round(abs(last - first) / step)
    return [Pose2(float(x), 0.3 * math.sin(x), 0.2 * math.sin(0.7 * x)) for x in np.linspace(first, last, count)]


def feed(
    tracker: MapTracker, walls: Floats, poses: Sequence[Pose2], odometry: Pose2, seed: int = 0
) -> list[MapEstimate]:
    """Add the scans of a path; `odometry` is the pose of the true frame in that of odometry."""
    return [
        tracker.add_scan(scan_at(walls, pose, 0.01, seed + number), odometry.compose(pose))
        for number, pose in enumerate(poses)
    ]


def distances(points: Floats, walls: Floats) -> Floats:
    """The distance (n) of points from the nearest wall, m."""
    start, along = walls[:, 0], walls[:, 1] - walls[:, 0]
    delta = points[:, None] - start
    place = np.clip((delta * along).sum(axis=2) / np.square(along).sum(axis=1), 0.0, 1.0)
    nearest: Floats = np.linalg.norm(delta - place[..., None] * along, axis=2).min(axis=1)
    return nearest
