"""Logs: scans with odometry and, where there is one, the truth. The errors of poor sensors are added here."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """A drive. Poses are (n, 3) in m and rad, one row per scan; `ranges` is (n, beams) in m, inf for no echo.

    `reference` holds the true poses in the frame of the world (those of public logs are corrected ones). `angles`
    (beams) are in the frame of the lidar, whose place on the robot is `mount`. `loops`, where a log has its own, are
    the pairs (m, 2) of scans that errors are measured between; None: they are found in the reference.
    """

    name: str
    stamps: Floats
    ranges: NDArray[np.float32]
    angles: Floats
    mount: Pose2
    range_limits: tuple[float, float]
    odometry: Floats
    reference: Floats
    loops: NDArray[np.intp] | None = None

    def __len__(self) -> int:
        return len(self.stamps)

    @property
    def directions(self) -> Floats:
        """Unit vectors (beams, 2) of the beams in the frame of the lidar."""
        return np.column_stack((np.cos(self.angles), np.sin(self.angles)))


def compose(poses: Floats, steps: Floats) -> Floats:
    """Rows of `steps` (n, 3), each given in the frame of the row of `poses` (n, 3), in the parent frame."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.column_stack(
        (
            poses[:, 0] + c * steps[:, 0] - s * steps[:, 1],
            poses[:, 1] + s * steps[:, 0] + c * steps[:, 1],
            poses[:, 2] + steps[:, 2],
        )
    )


def steps_of(poses: Floats) -> Floats:
    """The motions (n - 1, 3) from each pose to the next, in the frame of the former."""
    delta = np.diff(poses, axis=0)
    c, s = np.cos(poses[:-1, 2]), np.sin(poses[:-1, 2])
    turns = np.remainder(delta[:, 2] + math.pi, 2.0 * math.pi) - math.pi
    return np.column_stack((c * delta[:, 0] + s * delta[:, 1], c * delta[:, 1] - s * delta[:, 0], turns))


def chain(steps: Floats, start: Floats) -> Floats:
    """The poses (n + 1, 3) that motions (n, 3) lead to from a start (3)."""
    poses = [start]
    for step in steps:
        poses.append(compose(poses[-1][None], step[None])[0])
    return np.array(poses)


def with_poor_sensors(log: Log, seed: int) -> Log:
    """Make the odometry 5 % long and turn 3 degrees a metre; cut the lidar to 180 degrees and 5 m, noise 0.03 m."""
    random = np.random.default_rng(seed)
    steps = steps_of(log.odometry)
    steps[:, :2] *= 1.05
    steps[:, 2] += math.radians(3.0) * np.hypot(steps[:, 0], steps[:, 1])
    ahead = np.abs(log.angles) <= math.pi / 2.0
    ranges = log.ranges[:, ahead] + random.standard_normal((len(log), int(ahead.sum()))).astype(np.float32) * 0.0283
    ranges[ranges > 5.0] = np.inf
    return replace(
        log,
        name=f"{log.name}, poor sensors",
        ranges=ranges,
        angles=log.angles[ahead],
        range_limits=(log.range_limits[0], 5.0),
        odometry=chain(steps, log.odometry[0]),
    )


def with_odometry_noise(log: Log, seed: int) -> Log:
    """Add odometry noise to a log whose odometry is corrected: scale, drift, and a random walk, drawn from a seed."""
    random = np.random.default_rng(seed)
    steps = steps_of(log.odometry)
    way = np.hypot(steps[:, 0], steps[:, 1])
    walk = np.sqrt(way)
    steps[:, :2] *= 1.0 + random.normal(0.0, 0.02)
    steps[:, :2] += random.standard_normal((len(steps), 2)) * (0.007 * walk)[:, None]
    steps[:, 2] += math.radians(random.normal(0.0, 0.1)) * way
    steps[:, 2] += random.standard_normal(len(steps)) * math.radians(0.7) * walk
    return replace(log, odometry=chain(steps, log.odometry[0]))
