"""Detection of a lost robot: whether scans still fit the map at the estimated pose. Pure.

People and new furniture make beams shorter than the map says, and a robot among them keeps its pose. A robot that was
carried away also sees through walls of the map, which objects that were added to a room cannot cause.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.likelihood import OCCUPIED_FROM

LOST = 4.0
"""Doubt from which the robot counts as lost."""

_BEHIND = 0.3  # m: a beam that ends so far behind a wall has passed it
_MOST_SAMPLES = 400  # along a beam
LITTLE = 0.5
"""Agreement from which a scan is not doubted, even where its beams pass through walls."""

_CONTRADICTED = 0.15  # share of the beams that pass walls
_NEARLY_NONE, _SLOWLY = 0.15, 0.15  # agreement that is doubted, too, but slowly: a crowd may stand round the robot
_GOOD, _CLEAR = 0.6, 0.1


@dataclass(frozen=True, slots=True)
class PoseFit:
    """A scan at a pose on the map: shares (0..1) of its beams that end on walls, and that pass through walls."""

    agreement: float
    through: float

    @property
    def is_good(self) -> bool:
        """Return whether the scan fits this pose well."""
        return self.agreement >= _GOOD and self.through <= _CLEAR

    @property
    def is_contradicted(self) -> bool:
        """Return whether the scan sees through walls here, which no objects or people can cause."""
        return self.agreement < LITTLE and self.through > _CONTRADICTED


def step_doubt(doubt: float, fit: PoseFit) -> float:
    """Return the doubt after one more scan: it grows by at most 1, and is at least 0."""
    if fit.is_contradicted:
        return doubt + 1.0
    return doubt + _SLOWLY if fit.agreement < _NEARLY_NONE else max(0.0, doubt - 1.0)


def share_through_walls(grid: Grid, pose: Pose2, points: NDArray[np.float64]) -> float:
    """Return the share (0..1) of beams that end well behind a wall.

    `points` (n, 2) are their ends in the robot's frame, m.
    """
    lengths = np.hypot(*points.T)
    free = lengths - _BEHIND
    if not (free > 0.0).any():
        return 0.0
    step = max(grid.resolution, float(free.max()) / _MOST_SAMPLES)
    along = np.arange(step, float(free.max()) + step, step)
    beam, sample = np.nonzero(along < free[:, None])
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    directions = (points / np.maximum(lengths, 1e-9)[:, None]) @ np.array(((c, s), (-s, c)))
    places = pose[:2] + directions[beam] * along[sample, None]
    passed = np.zeros(len(points), bool)
    passed[beam[grid.values_at(places, outside=0) >= OCCUPIED_FROM]] = True
    return float(passed.mean())
