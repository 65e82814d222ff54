"""Conversion of a lidar's ranges to a scan for mapping, in the robot's frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount, classify_ranges, ends_of_beams
from ur_nodes.slam.matching.surface import Floats, Surface, beam_spacing, surface_of_points

MOST_POINTS = 400
"""Beams that are matched; scans with more are thinned."""

_BETWEEN = 100  # numbers between the beams of two lidars
_MOST_NUMBERS = 65535  # of beams, as they are stored


@dataclass(frozen=True, slots=True, eq=False)
class MapScan:
    """`hits` (n, 2) are the ends of beams that hit something, `misses` (m, 2) of the others; `surface` is matched.

    All are in the robot's frame, as is the lidar's place, `origin` (2). `numbers` (n) are those of the beams that hit.
    The surface is made of every so many hits; of these, `facing` (k) are the directions of the normals in rad, and
    `flat` (k) is whether they can be trusted: 16 bytes a point, as a map holds thousands of scans.
    """

    hits: NDArray[np.float32]
    misses: NDArray[np.float32]
    origin: Floats
    numbers: NDArray[np.uint16]
    facing: NDArray[np.float32]
    flat: NDArray[np.bool_]

    @property
    def surface(self) -> Surface:
        """The points that are matched, recomputed at each access."""
        facing = self.facing.astype(np.float64)
        step = _step(len(self.hits))
        hits = self.hits.astype(np.float64)
        spacing = beam_spacing(hits, self.numbers.astype(np.intp), self.origin)
        normals = np.column_stack((np.cos(facing), np.sin(facing)))
        return Surface(hits[::step], normals, self.flat, spacing[::step])

    def moved(self, pose: Pose2) -> MapScan:
        """Express the scan in the parent frame of `pose`, as if it was taken from elsewhere."""
        return MapScan(
            pose.transform_points(self.hits).astype(np.float32),
            pose.transform_points(self.misses).astype(np.float32),
            pose.transform_points(self.origin),
            self.numbers,
            (self.facing + np.float32(pose.yaw)).astype(np.float32),
            self.flat,
        )


def _step(count: int) -> int:
    return max(1, -(-count // MOST_POINTS))


def make_scan(
    ranges: NDArray[np.floating], directions: Floats, limits: tuple[float, float], mount: SensorMount, free: float = 0.0
) -> MapScan:
    """Make a scan from ranges (n) in m along `directions` (n, 2) in the lidar's plane.

    Readings within `limits` have hit something. Clear ones leave the floor free up to `free` m (0: no readings,
    as many lidars see no glass).
    """
    values = np.asarray(ranges, dtype=np.float64)
    returns = classify_ranges(values, limits)
    points = ends_of_beams(directions[returns.hits], values[returns.hits], mount)
    misses = ends_of_beams(directions[returns.clear if free > 0.0 else []], free, mount)
    stored = np.minimum(np.flatnonzero(returns.hits), _MOST_NUMBERS).astype(np.uint16)
    return restore_scan(points.astype(np.float32), stored, misses.astype(np.float32), mount.offset[:2])


def join_scans(scans: Sequence[MapScan]) -> MapScan:
    """Join scans, at least one, of several lidars of one robot at one time; its origin is the mean of theirs."""
    if len(scans) == 1:
        return scans[0]
    numbers, first = [], 0
    for scan in scans:  # beams of two lidars are no neighbours
        numbers.append(scan.numbers.astype(np.intp) + first)
        first = int(numbers[-1].max(initial=first)) + _BETWEEN
    stored = np.minimum(np.concatenate(numbers), _MOST_NUMBERS).astype(np.uint16)
    hits = np.concatenate([scan.hits for scan in scans])
    misses = np.concatenate([scan.misses for scan in scans])
    return restore_scan(hits, stored, misses, np.mean([scan.origin for scan in scans], axis=0))


def restore_scan(
    hits: NDArray[np.float32], numbers: NDArray[np.uint16], misses: NDArray[np.float32], origin: Floats
) -> MapScan:
    """Restore a scan from its stored fields."""
    surface = surface_of_points(hits.astype(np.float64), numbers.astype(np.intp), origin, _step(len(hits)))
    facing = np.arctan2(surface.normals[:, 1], surface.normals[:, 0]).astype(np.float32)
    return MapScan(hits, misses, origin, numbers, facing, surface.flat)
