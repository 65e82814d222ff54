"""Places of a map that fit the scans alike, and the nearest thing that would tell them apart. Pure."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.distance import squared_distances
from ur_nodes.geometry.grid import FREE, Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.localisation.likelihood import OCCUPIED_FROM
from ur_nodes.localisation.particle_filter import Cluster, Particles, find_best_cluster

_LEAST_SHARE = 0.1  # of the weight of the best place: what another one must have
_MOST_PLACES = 4
_APART = (1.0, 0.6)  # m, rad: nearer particles belong to the same place
_REACH = 12.0  # m: where a difference is looked for
_STEP = 0.05  # m
_TOLERANCE = 0.3  # m: a wall that is farther from the other place's walls is a difference
_SIZE = 3  # points of it at least, so that one wrong cell is none


def find_places(particles: Particles) -> list[Cluster]:
    """The heaps of particles that hold at least a tenth of the weight of the heaviest one, that first."""
    poses, weights = particles.poses, particles.weights
    found: list[Cluster] = []
    while len(found) < _MOST_PLACES and float(weights.sum()) > 0.0:
        left = float(weights.sum())
        best = find_best_cluster(Particles(poses, weights / left))
        found.append(Cluster(best.pose, best.covariance, best.share * left))
        far = np.hypot(*(poses[:, :2] - best.pose[:2]).T) > _APART[0]
        far |= np.abs(wrap_angle(poses[:, 2] - best.pose.yaw)) > _APART[1]
        poses, weights = poses[far], weights[far]
    found.sort(key=lambda place: -place.share)
    return [place for place in found if place.share >= _LEAST_SHARE * found[0].share]


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
        walls.append(values >= OCCUPIED_FROM)
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
    """The marks (rows, columns) that have some others round them."""
    padded = np.pad(marks, 1).astype(np.int8)
    rows, columns = marks.shape
    count = sum(padded[y : y + rows, x : x + columns] for y in range(3) for x in range(3))
    heaped: NDArray[np.bool_] = marks & (count >= _SIZE)
    return heaped
