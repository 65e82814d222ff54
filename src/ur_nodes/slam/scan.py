"""From a lidar's ranges to what mapping needs of a scan, in the robot's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.slam.surface import Floats, Surface, surface_of_points

MOST_POINTS = 400
"""Beams that are matched; scans with more are thinned."""

_MOST_NUMBERS = 65535  # of beams, as they are stored


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """`surface` is matched. `hits` (n, 2) are the ends of beams that hit something, `misses` (m, 2) of the others.

    All are in the robot's frame, as is the lidar's place, `origin` (2). `numbers` (n) are those of the beams that hit.
    """

    surface: Surface
    hits: NDArray[np.float32]
    misses: NDArray[np.float32]
    origin: Floats
    numbers: NDArray[np.uint16]


def make_scan(
    ranges: NDArray[np.floating],
    directions: Floats,
    limits: tuple[float, float],
    rotation: Floats,
    offset: Floats,
    free: float = 0.0,
) -> Scan:
    """Make a scan from ranges (n) in m along `directions` (n, 2) in the lidar's plane.

    Readings within `limits` (the upper one not included) have hit something. Longer ones leave the floor free up to
    `free` m (0: they say nothing, as many lidars see no glass). `rotation` (2, 2) and `offset` (2) are the planar part
    of the lidar's mount; a mirrored one stands for a lidar that hangs upside down.
    """
    values = np.asarray(ranges, dtype=np.float64)
    seen = (values >= limits[0]) & (values < limits[1])  # false for nan and inf
    numbers = np.flatnonzero(seen)
    points = (directions[seen] * values[seen, None]) @ rotation.T + offset
    surface = surface_of_points(points, numbers, offset)
    beyond = values >= limits[1] if free > 0.0 else np.zeros(len(values), dtype=bool)
    misses = directions[beyond] * free @ rotation.T + offset
    return Scan(
        surface.thinned(MOST_POINTS),
        points.astype(np.float32),
        misses.astype(np.float32),
        offset,
        np.minimum(numbers, _MOST_NUMBERS).astype(np.uint16),
    )


def restore_scan(
    hits: NDArray[np.float32], numbers: NDArray[np.uint16], misses: NDArray[np.float32], origin: Floats
) -> Scan:
    """Make the scan again whose fields these are."""
    surface = surface_of_points(hits.astype(np.float64), numbers.astype(np.intp), origin)
    return Scan(surface.thinned(MOST_POINTS), hits, misses, origin, numbers)
