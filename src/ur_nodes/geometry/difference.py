"""The nearest feature of a map that distinguishes two places, in words. Pure."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.distance import squared_distances
from ur_nodes.geometry.grid import FREE, Grid
from ur_nodes.geometry.pose import Pose2

_OCCUPIED_FROM = 65  # of 100: the limit that the costmaps use
_REACH = 12.0  # m: where a difference is looked for
_STEP = 0.05  # m
_TOLERANCE = 0.3  # m: a wall that is farther from the other place's walls is a difference
_SIZE = 3  # points of it at least, so that one wrong cell is none
_MOST_PLACES = 4  # that a message names


def describe_poses(grid: Grid, poses: Sequence[Pose2], where_alike: str) -> str:
    """Describe poses of a robot, at least two, that fit its scans alike, the best first, and the next step.

    The next step is to drive to where the first two differ; `where_alike` where the map is the same round them.
    """
    shown = ", ".join(f"({place.x:.2f}, {place.y:.2f})" for place in poses[:_MOST_PLACES])
    nearest = find_difference(grid, *poses[:2])
    if nearest:
        where = f"{math.hypot(*nearest):.1f} m {name_direction(*nearest)}"
        advice = f"the first two differ {where} of the robot: drive there"
    else:
        advice = f"the map is the same round the first two: {where_alike}"
    return f"{len(poses)} places on the map fit: {shown}; {advice}"


def find_difference(grid: Grid, one: Pose2, other: Pose2) -> tuple[float, float] | None:
    """Find where the map round one pose differs from that round another one, nearest to the robot.

    Returns the point in the robot's frame (m ahead, m to the left): a wall at one of the poses, and free floor without
    a wall near by at the other. None when there is none within 12 m.
    """
    side = np.arange(-_REACH, _REACH + _STEP, _STEP)
    points = np.stack(np.meshgrid(side, side, indexing="xy"), axis=-1)
    walls, free = [], []
    for pose in (one, other):
        values = grid.values_at(pose.transform_points(points.reshape(-1, 2))).reshape(points.shape[:2])
        walls.append(values >= _OCCUPIED_FROM)
        free.append(values == FREE)
    cells = math.ceil(_TOLERANCE / _STEP)
    differs = np.zeros(points.shape[:2], np.bool_)
    for here, there in ((0, 1), (1, 0)):
        differs |= walls[here] & free[there] & (squared_distances(walls[there], cells) > cells * cells)
    found = points[_heaped(differs)]
    if not len(found):
        return None
    x, y = found[np.argmin(np.hypot(*found.T))]
    return float(x), float(y)


def name_direction(x: float, y: float) -> str:
    """Name the direction of a point in the robot's frame in words."""
    return _DIRECTIONS[round(math.atan2(y, x) / (0.25 * math.pi)) % len(_DIRECTIONS)]


_DIRECTIONS = (
    "ahead",
    "ahead to the left",
    "to the left",
    "behind to the left",
    "behind",
    "behind to the right",
    "to the right",
    "ahead to the right",
)


def _heaped(marks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the marks (rows, columns) with other marks around them."""
    padded = np.pad(marks, 1).astype(np.int8)
    rows, columns = marks.shape
    count = sum(padded[y : y + rows, x : x + columns] for y in range(3) for x in range(3))
    heaped: NDArray[np.bool_] = marks & (count >= _SIZE)
    return heaped
