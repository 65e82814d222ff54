"""Poses in frames, paths, maps and transforms."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3


@dataclass(frozen=True, slots=True)
class StampedPose:
    """A pose in a frame."""

    stamp: int
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class PoseEstimate:
    """A pose in a frame, and its covariance (3, 3) of x, y, yaw in m, rad."""

    stamp: int
    frame: str
    pose: Pose2
    covariance: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Poses (n, 3) float64 in a frame, m, m, rad, without an order."""

    stamp: int
    frame: str
    poses: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """Poses (n, 3) float64 in a frame, m, m, rad, in the order in which they are driven."""

    stamp: int
    frame: str
    poses: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A polygon: corners (n, 2) float64 in a frame, m."""

    stamp: int
    frame: str
    corners: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Map:
    """A grid in a frame."""

    stamp: int
    frame: str
    grid: Grid


@dataclass(frozen=True, slots=True)
class MapInfo:
    """The moment at which a map was made, its resolution (m) and size (cells), and the pose of its first cell."""

    stamp: int
    resolution: float
    width: int
    height: int
    origin: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class MapUpdate:
    """Cells of a map that have changed: `values` int8 (rows, columns), the first at `row`, `column` of the map."""

    stamp: int
    frame: str
    row: int
    column: int
    values: NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Transform:
    """The pose of `child` in `parent`; `fixed`: it never changes."""

    stamp: int
    parent: str
    child: str
    pose: Pose3
    fixed: bool = False
