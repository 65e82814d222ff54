"""From a lidar's ranges to the ends of its beams in the robot's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Mount:
    """Where a lidar sits: `rotation` (3, 3) and `offset` (3) in m of its frame in the robot's."""

    rotation: NDArray[np.float64]
    offset: NDArray[np.float64]


def mount_of_quaternion(offset: tuple[float, float, float], quaternion: tuple[float, float, float, float]) -> Mount:
    """A mount from a translation (m) and a quaternion (x, y, z, w), which need not have length 1."""
    x, y, z, w = np.asarray(quaternion) / np.linalg.norm(quaternion)
    rotation = np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )
    return Mount(rotation, np.asarray(offset, dtype=np.float64))


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

    The lower limit counts as within, the upper does not: that is how many drivers say "nothing there". A lidar that
    hangs upside down or is tilted is allowed for by its mount.
    """
    seen = (ranges >= limits[0]) & (ranges < limits[1])  # false for nan and inf
    flat = directions[seen] * np.asarray(ranges, dtype=np.float64)[seen, None]
    points: NDArray[np.float64] = flat @ mount.rotation[:2, :2].T + mount.offset[:2]
    return points
