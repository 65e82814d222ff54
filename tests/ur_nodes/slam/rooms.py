"""Rooms made of straight walls, and the scans that a lidar at the robot's centre sees in them."""

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.slam.matching.scan import MapScan, make_scan

Floats = NDArray[np.float64]
ANGLES = np.linspace(-math.pi, math.pi, 360, endpoint=False)
DIRECTIONS = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
CENTRE = SensorMount(np.eye(3), np.zeros(3))
RANGE = 12.0


def walls_of(*rings: tuple[tuple[float, float], ...]) -> Floats:
    """The walls (n, 2, 2) between the corners of closed rings."""
    walls = [(ring[i], ring[(i + 1) % len(ring)]) for ring in rings for i in range(len(ring))]
    return np.array(walls)


def box(left: float, low: float, right: float, high: float) -> tuple[tuple[float, float], ...]:
    return ((left, low), (right, low), (right, high), (left, high))


ROOM = walls_of(box(-3.0, -2.0, 4.0, 3.0), box(1.0, 1.0, 1.8, 1.6), box(-2.0, -1.2, -1.5, -0.4))
CORRIDOR = walls_of(box(-40.0, -1.0, 40.0, 1.0))


def ranges_at(walls: Floats, pose: Pose2, noise: float = 0.0, seed: int = 0, reach: float = RANGE) -> Floats:
    """The ranges (360) from a pose, m; inf beyond `reach`."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    beams = DIRECTIONS @ np.array(((c, s), (-s, c)))
    start, along = walls[:, 0] - (pose.x, pose.y), walls[:, 1] - walls[:, 0]
    cross = beams[:, None, 0] * along[None, :, 1] - beams[:, None, 1] * along[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / cross
        place = (start[None, :, 0] * beams[:, None, 1] - start[None, :, 1] * beams[:, None, 0]) / cross
    hit = (distance > 0.0) & (place >= 0.0) & (place <= 1.0)
    ranges: Floats = np.where(hit, distance, np.inf).min(axis=1)
    ranges = ranges + np.random.default_rng(seed).standard_normal(len(ranges)) * noise
    return np.where(ranges < reach, ranges, np.inf)


def scan_at(
    walls: Floats, pose: Pose2, noise: float = 0.0, seed: int = 0, view: float = 2.0 * math.pi, reach: float = RANGE
) -> MapScan:
    """The scan that a robot at a pose sees with a lidar of so wide a view (rad), ahead, and of so long a reach (m)."""
    ahead = np.abs(ANGLES) <= 0.5 * view
    ranges = ranges_at(walls, pose, noise, seed, reach)[ahead]
    return make_scan(ranges, DIRECTIONS[ahead], (0.1, reach), CENTRE)
