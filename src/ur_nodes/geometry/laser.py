"""From a lidar's ranges to the ends of its beams in the robot's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose3
from ur_nodes.geometry.rigid import from_pose


@dataclass(frozen=True, slots=True, eq=False)
class Mount:
    """The mounting of a lidar: `rotation` (3, 3) and `offset` (3) in m of its frame in the robot's."""

    rotation: NDArray[np.float64]
    offset: NDArray[np.float64]


def mount_of_pose(pose: Pose3) -> Mount:
    """Return the mount of a lidar from the pose of its frame in the robot's."""
    rigid = from_pose(pose)
    return Mount(rigid[:3, :3], rigid[:3, 3])


def directions_of_beams(count: int, angle_min: float, angle_increment: float) -> NDArray[np.float64]:
    """Unit vectors (count, 2) of the beams in the lidar's plane; angles in rad."""
    angles = angle_min + np.arange(count) * angle_increment
    return np.column_stack((np.cos(angles), np.sin(angles)))


def points_of_ranges(
    ranges: NDArray[np.floating],
    directions: NDArray[np.float64],
    limits: tuple[float, float],
    mount: Mount,
) -> NDArray[np.float64]:
    """The ends (m, 2) on the ground plane of the robot's frame of the beams whose ranges (n) are within `limits` (m).

    The lower limit counts as within, the upper does not: many drivers report "no obstacle" so. A lidar that
    hangs upside down or is tilted is allowed for by its mount.
    """
    seen = (ranges >= limits[0]) & (ranges < limits[1])  # false for nan and inf
    flat = directions[seen] * np.asarray(ranges, dtype=np.float64)[seen, None]
    points: NDArray[np.float64] = flat @ mount.rotation[:2, :2].T + mount.offset[:2]
    return points
