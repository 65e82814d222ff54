"""The surfaces around the robot, from several keyframes, to which a scan is matched."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.correlative import Pyramid
from ur_nodes.slam.matching.surface import Floats, Surface, face, fit_lines, join

FACING = 0.15
"""m: surfaces that face opposite ways count as twice this farther apart, so that a thin wall has two sides."""

_NEIGHBOURS = 14
_REACH = 0.25  # m: points that far apart do not smooth each other,
_SPREAD = 0.10  # m: how fast their weight falls before,
_BEAMS = (3.0, 1.2)  # and so many times the distance between beams, where that is more
_GAP = 0.15  # m: walls are filled up between points farther apart,
_BEAMS_APART = 1.6  # but not so many times the distance between beams,
_ON_ONE_WALL = 0.04  # m: that lie so near to each other's lines,
_SHARES = (0.25, 0.5, 0.75)  # at these shares of the gap
_MOST = 6000  # points
_CLOSE = 0.155  # m: to a neighbour of a point in a clump
_CLUMP = 5  # such neighbours; with fewer, points only look apart because the lidar is far away


class LocalMap:
    """Points of several scans, projected onto the lines of their neighbours to average out noise."""

    def __init__(self, placed: Sequence[tuple[Pose2, Surface]]) -> None:
        """Join surfaces, each given with the pose of its frame.

        `surface` are the points; `clumped` (n): those that lie close together, but not on a line.
        """
        rough = join([surface.moved(pose) for pose, surface in placed]).thinned(_MOST)
        self.surface, self.clumped = _filled(*_smoothed(rough))
        self._tree = cKDTree(_keys(self.surface.points, self.surface.normals))

    @cached_property
    def pyramid(self) -> Pyramid:
        """The same points for a search; made on first use."""
        return Pyramid(self.surface.points)

    def nearest(self, points: Floats, normals: Floats, reach: float) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Return the index (n) of the nearest point with a similar normal, and whether it is within `reach` m."""
        distances, numbers = self._tree.query(_keys(points, normals), distance_upper_bound=reach)
        found = np.isfinite(distances)
        return np.where(found, numbers, 0), found


def _keys(points: Floats, normals: Floats) -> Floats:
    return np.hstack((points, FACING * normals))


def _smoothed(rough: Surface) -> tuple[Surface, NDArray[np.bool_]]:
    tree = cKDTree(_keys(rough.points, rough.normals))
    count = max(1, min(_NEIGHBOURS, len(rough)))
    distances, numbers = tree.query(_keys(rough.points, rough.normals), k=list(range(1, count + 1)))
    reach = np.maximum(_REACH, _BEAMS[0] * rough.spacing)[:, None]
    spread = np.maximum(_SPREAD, _BEAMS[1] * rough.spacing)[:, None]
    near = np.isfinite(distances) & (distances < reach)
    delta = rough.points[numbers] - rough.points[:, None]
    weights = np.where(near, np.exp(-0.5 * np.square(distances / spread)), 0.0)
    mean, normals, flat = fit_lines(delta, weights)
    normals = face(normals, rough.normals)
    off = (mean * normals).sum(axis=1)
    points = rough.points + np.where(flat, off, 0.0)[:, None] * normals
    close = np.isfinite(distances) & (distances < _CLOSE)
    clumped = ~flat & (close.sum(axis=1) >= _CLUMP)
    return Surface(points, np.where(flat[:, None], normals, rough.normals), flat, rough.spacing), clumped


def _filled(surface: Surface, clumped: NDArray[np.bool_]) -> tuple[Surface, NDArray[np.bool_]]:
    """Add points between distant neighbours on one wall, as the wall continues there."""
    sparse = np.flatnonzero(surface.flat & (surface.spacing > _GAP))
    if len(sparse) < 2:
        return surface, clumped
    points, normals, spacing = surface.points[sparse], surface.normals[sparse], surface.spacing[sparse]
    pairs = cKDTree(points).query_pairs(_BEAMS_APART * float(spacing.max()), output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    delta = points[second] - points[first]
    length = np.hypot(delta[:, 0], delta[:, 1])
    off = np.maximum(*(np.abs((delta * normals[each]).sum(axis=1)) for each in (first, second)))
    neighbours = (length > _GAP) & (length < _BEAMS_APART * np.minimum(spacing[first], spacing[second]))
    neighbours &= (off < _ON_ONE_WALL) & ((normals[first] * normals[second]).sum(axis=1) > 0.0)
    first, delta = first[neighbours], delta[neighbours]
    flat = np.ones(len(first), dtype=np.bool_)
    between = [Surface(points[first] + share * delta, normals[first], flat, spacing[first]) for share in _SHARES]
    whole = join([surface, *(each.thinned(_MOST) for each in between)])
    return whole, np.concatenate((clumped, np.zeros(len(whole) - len(clumped), dtype=np.bool_)))
