"""Beams and points of a lidar's scan, with one reading of REP 117 for all nodes."""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.rigid import from_pose


class RangeScan(Protocol):
    """Fields of a scan that its geometry depends on, named as in sensor_msgs/LaserScan."""

    @property
    def angle_min(self) -> float:
        """Angle of the first beam, rad."""

    @property
    def angle_increment(self) -> float:
        """Angle from one beam to the next, rad."""

    @property
    def range_min(self) -> float:
        """Least range that counts, m."""

    @property
    def range_max(self) -> float:
        """Range (m) from which on nothing was met."""

    @property
    def ranges(self) -> Sequence[float] | NDArray[np.floating]:
        """Ranges (n) of the beams, m; REP 117 has the special values."""


@dataclass(frozen=True, slots=True, eq=False)
class SensorMount:
    """The mounting of a sensor: `rotation` (3, 3) and `offset` (3) in m of its frame in the robot's."""

    rotation: NDArray[np.float64]
    offset: NDArray[np.float64]

    def planar(self) -> Pose2:
        """Return the pose seen from above."""
        return Pose2(float(self.offset[0]), float(self.offset[1]), math.atan2(self.rotation[1, 0], self.rotation[0, 0]))


def mount_of_pose(pose: Pose3) -> SensorMount:
    """Return the mount of a sensor from the pose of its frame in the robot's."""
    rigid = from_pose(pose)
    return SensorMount(rigid[:3, :3], rigid[:3, 3])


@dataclass(frozen=True, slots=True, eq=False)
class Returns:
    """Masks (n) of the beams by the meaning of their ranges; a beam in none of them is no reading.

    `hits` have met something at their range, `clear` nothing within the upper limit, and `near` something nearer than
    the sensor can measure.
    """

    hits: NDArray[np.bool_]
    clear: NDArray[np.bool_]
    near: NDArray[np.bool_]


def classify_ranges(ranges: NDArray[np.floating], limits: tuple[float, float]) -> Returns:
    """Classify ranges (n) in m by REP 117 and the `limits` (m) within which they count.

    The lower limit counts as within, the upper does not: many drivers report "no obstacle" so. +inf and what is at the
    upper limit or beyond is clear, -inf is near; NaN and other ranges below the lower limit are no readings. Limits are
    compared in the precision of the ranges.
    """
    low, high = limits
    return Returns((ranges >= low) & (ranges < high), ranges >= high, ranges == -math.inf)


@functools.lru_cache(maxsize=8)
def angles_of_beams(count: int, angle_min: float, angle_increment: float) -> NDArray[np.float64]:
    """Angles (count) of the beams in rad; not to be written to."""
    return _fixed(angle_min + angle_increment * np.arange(count, dtype=np.float64))


@functools.lru_cache(maxsize=8)
def directions_of_beams(count: int, angle_min: float, angle_increment: float) -> NDArray[np.float64]:
    """Unit vectors (count, 2) of the beams in the lidar's plane, from angles in rad; not to be written to."""
    angles = angles_of_beams(count, angle_min, angle_increment)
    return _fixed(np.column_stack((np.cos(angles), np.sin(angles))))


def directions_of_scan(scan: RangeScan) -> NDArray[np.float64]:
    """Unit vectors (n, 2) of the beams of a scan in the lidar's plane; not to be written to."""
    return directions_of_beams(len(scan.ranges), scan.angle_min, scan.angle_increment)


def ends_of_beams(
    directions: NDArray[np.float64], ranges: NDArray[np.floating] | float, mount: SensorMount
) -> NDArray[np.float64]:
    """The ends (n, 2) on the ground plane of the robot's frame of beams along unit vectors (n, 2), ranges (n) or one.

    A lidar that hangs upside down or is tilted is allowed for by its mount.
    """
    flat = directions * np.asarray(ranges, dtype=np.float64)[..., None]
    points: NDArray[np.float64] = flat @ mount.rotation[:2, :2].T + mount.offset[:2]
    return points


def points_of_scan(
    scan: RangeScan, mount: SensorMount, limits: tuple[float, float] | None = None
) -> NDArray[np.float64]:
    """The points (m, 2) on the ground plane of the robot's frame that a scan has hit.

    Ranges count within `limits` (m), by default those of the scan.
    """
    ranges = np.asarray(scan.ranges, dtype=np.float32)
    hits = classify_ranges(ranges, limits or (scan.range_min, scan.range_max)).hits
    return ends_of_beams(directions_of_scan(scan)[hits], ranges[hits], mount)


def _fixed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    values.flags.writeable = False
    return values
