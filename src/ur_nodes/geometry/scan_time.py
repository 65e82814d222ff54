"""The time that a lidar takes for a scan, and the robot's motion meanwhile, taken out of the ranges."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import RangeScan, SensorMount, angles_of_beams

LONGEST_TURN = 1.0  # s between the first and the last beam; what takes longer is no turn of a lidar


class TimedScan(RangeScan, Protocol):
    """A scan whose beams are not measured at once, named as in sensor_msgs/LaserScan."""

    @property
    def time_increment(self) -> float:
        """Time from one beam to the next, s."""


def turn_time(scan: TimedScan) -> float:
    """The time (s) from the first beam of a scan to its last, negative where the last is measured first.

    0.0 where no lidar takes so long.
    """
    turn = (len(scan.ranges) - 1) * scan.time_increment
    return turn if abs(turn) <= LONGEST_TURN else 0.0


_JOINED = 0.1  # of the range: two beams that differ by less have met the same surface
_GAP = 1.5  # beams: where the nearest one is farther, nothing was measured


def velocity_between(start: Pose2, end: Pose2, seconds: float) -> tuple[float, float, float]:
    """The velocity of a robot from one pose to another (m/s, m/s, rad/s), in its frame at the middle of the time."""
    x, y, turn = start.inverse().compose(end)
    c, s = math.cos(-turn / 2.0), math.sin(-turn / 2.0)
    return (c * x - s * y) / seconds, (s * x + c * y) / seconds, turn / seconds


def ranges_at_one_moment(
    ranges: NDArray[np.float32],
    angle_min: float,
    increment: float,
    times: NDArray[np.float64],
    velocity: tuple[float, float, float] | NDArray[np.float64],
    mount: SensorMount,
) -> NDArray[np.float32]:
    """The ranges (n) that a lidar would have measured at time 0, from those (n) that it measured at `times` (n), s.

    `velocity` is the robot's, as `velocity_between`, or that of each beam (3, n). NaN where no beam was.
    """
    ahead, aside, turning = velocity
    x, y, _ = mount.offset
    vx, vy = mount.rotation[:2, :2].T @ np.array((ahead - turning * y, aside + turning * x))
    turning = turning * float(mount.rotation[2, 2])
    angles = angles_of_beams(len(ranges), angle_min, increment)
    hit = np.isfinite(ranges)
    directions = angles + turning * times
    lengths = np.where(hit, ranges, 0.0)
    px, py = lengths * np.cos(directions) + vx * times, lengths * np.sin(directions) + vy * times
    moved = np.where(hit, np.hypot(px, py), ranges)
    shift = np.where(hit, np.remainder(np.arctan2(py, px) - angles + math.pi, 2.0 * math.pi) - math.pi, turning * times)
    return _resample(angles, angles + shift, moved, increment)


def _resample(
    angles: NDArray[np.float64], bearings: NDArray[np.float64], ranges: NDArray[np.float64], increment: float
) -> NDArray[np.float32]:
    """The ranges at `angles` (n) from those at `bearings` (n): on a line between neighbours of one surface."""
    known = ~np.isnan(ranges)
    if np.count_nonzero(known) < 2:
        return ranges.astype(np.float32)
    turns = np.concatenate([bearings[known] + turn for turn in (-2.0 * math.pi, 0.0, 2.0 * math.pi)])
    order = np.argsort(turns, kind="stable")
    turns, values = turns[order], np.tile(ranges[known], 3)[order]
    after = np.clip(np.searchsorted(turns, angles), 1, len(turns) - 1)
    left, right = turns[after - 1], turns[after]
    share = (angles - left) / np.maximum(right - left, 1e-9)
    before, behind = values[after - 1], values[after]
    nearest = np.where(share < 0.5, before, behind)
    with np.errstate(invalid="ignore"):
        joined = np.abs(before - behind) < _JOINED * np.minimum(before, behind)
        between = before + share * (behind - before)
    found = np.where(joined, between, nearest)
    away = np.minimum(np.abs(angles - left), np.abs(right - angles))
    return np.where(away <= _GAP * abs(increment), found, np.nan).astype(np.float32)
