"""The convex outline of a robot.

Distances are those of the outline moved outward edge by edge: exact along edges, at a corner at most the true distance.
All points are in the base's frame in m.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """A convex polygon: the points p with `normals` (edges, 2) @ p <= `offsets` (edges). `corners` (edges, 2), in m."""

    corners: Floats
    normals: Floats
    offsets: Floats
    radius: float  # m, about the origin

    def distances(self, points: Floats) -> Floats:
        """Distances (n) of points (n, 2) in m, negative inside."""
        away: Floats = (points @ self.normals.T - self.offsets).max(axis=1)
        return away

    def edge_points(self, start: float, end: float) -> Floats:
        """Points of the outline (n, 2), 2 cm apart, with directions from `start` counter-clockwise to `end`, rad."""
        pieces = []
        for corner, following in zip(self.corners, np.roll(self.corners, -1, axis=0), strict=True):
            count = max(2, math.ceil(math.dist(corner, following) / 0.02))
            pieces.append(corner + (following - corner) * (np.arange(count) / count)[:, None])
        points: Floats = np.concatenate(pieces)
        within = (np.arctan2(points[:, 1], points[:, 0]) - start) % (2.0 * math.pi) <= end - start
        chosen: Floats = points[within]
        return chosen


def hull_of_outline(outline: Sequence[tuple[float, float]]) -> Hull:
    """Return the convex hull of an outline of three points or more that do not lie on a line."""
    # Corners of the convex hull of sorted points, counter-clockwise (Andrew's monotone chain)
    points = sorted(set(outline))
    chains = []
    for ordered in (points, points[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(chain) > 1:
                (x0, y0), (x1, y1) = chain[-2:]
                if (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) > 0.0:
                    break
                chain.pop()
            chain.append((x, y))
        chains.append(chain[:-1])
    corners = np.array((chains[0] + chains[1]), dtype=np.float64)
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack((edges[:, 1], -edges[:, 0])) / np.hypot(*edges.T)[:, None]
    return Hull(corners, normals, (normals * corners).sum(axis=1), float(np.hypot(*corners.T).max()))
