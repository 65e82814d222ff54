"""A small world for tests of localisation: rays marched over a grid, and a robot whose odometry drifts."""

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

LASER = Pose2(0.1, 0.0, 0.0)
ANGLES: NDArray[np.float64] = np.arange(180, dtype=np.float64) * (2.0 * math.pi / 180.0) - math.pi
RANGE_MAX = 12.0


def make_room() -> Grid:
    """8 m x 6 m with walls of 0.1 m, a stub and a box, so that no two places look alike. Origin at (-1, -2)."""
    values = np.zeros((120, 160), dtype=np.int8)
    values[:2] = values[-2:] = 100
    values[:, :2] = values[:, -2:] = 100
    values[60:62, :70] = 100
    values[60:62, 90:110] = 100
    values[20:40, 110:124] = 100
    values[90:, 50:52] = 100
    values[105:112, 130:150] = 100
    return Grid(values, 0.05, Pose2(-1.0, -2.0, 0.0))


def cast_rays(
    grid: Grid, pose: Pose2, angles: NDArray[np.float64] = ANGLES, step: float = 0.005
) -> NDArray[np.float64]:
    """Ranges (n) in m from a laser at `pose` in the map's frame; inf where nothing is within RANGE_MAX."""
    distances = np.arange(step, RANGE_MAX, step)
    directions = np.stack((np.cos(angles + pose.yaw), np.sin(angles + pose.yaw)), axis=-1)
    ranges = np.full(len(angles), math.inf)
    going = np.arange(len(angles))  # the rays that have met nothing yet
    for part in np.array_split(distances, 12):
        points = np.array(pose[:2]) + part[None, :, None] * directions[going, None, :]
        hit = grid.values_at(points, outside=0) >= 65
        met = hit.any(axis=1)
        ranges[going[met]] = part[hit[met].argmax(axis=1)]
        going = going[~met]
    return ranges


def scan_points(grid: Grid, robot: Pose2, rng: np.random.Generator, noise: float = 0.01) -> NDArray[np.float64]:
    """The ends (m, 2) of the laser's beams in the robot's frame, with noise; beams that hit nothing are left out."""
    ranges = cast_rays(grid, robot.compose(LASER))
    seen = np.isfinite(ranges)
    noisy = ranges[seen] + rng.normal(0.0, noise, int(seen.sum()))
    angles = ANGLES[seen] + LASER.yaw
    return np.column_stack((LASER.x + noisy * np.cos(angles), LASER.y + noisy * np.sin(angles)))


class Drifter:
    """A robot that drives exactly, and odometry that does not: 2 % too far, half a degree per metre to the left."""

    def __init__(self, truth: Pose2, rng: np.random.Generator, slip: float = 0.0) -> None:
        """`slip`: the share of all motion by which the wheels turn more than that."""
        self.truth, self._claimed = truth, 1.0 + slip
        self.odometry = Pose2(5.0, 5.0, 1.0)  # odometry starts anywhere
        self._rng = rng

    def drive(self, distance: float, turn: float) -> None:
        """Drive, then turn."""
        self.truth = self.truth.compose(Pose2(distance, 0.0, turn))
        noise = self._rng.normal(0.0, (0.002, 0.002))
        distance, turn = self._claimed * distance, self._claimed * turn
        seen = Pose2(distance * 1.02 + noise[0] * distance, 0.0, turn * 1.01 + 0.009 * distance + noise[1] * distance)
        self.odometry = self.odometry.compose(seen)
