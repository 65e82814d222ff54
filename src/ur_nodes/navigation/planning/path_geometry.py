"""Polylines (n, 2) in m: lengths, even spacing, curvature, the nearest place."""

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def arc_lengths(points: Points) -> NDArray[np.float64]:
    """Return the distance (n) along a polyline from its start to each of its points."""
    steps = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.empty(0)
    return np.concatenate(((0.0,), np.cumsum(steps)))


def resample(points: Points, spacing: float) -> Points:
    """Resample a path evenly, about `spacing` apart; both ends stay. At least two points, unless there was one."""
    along = arc_lengths(points)
    if along[-1] < 1e-9:
        return points[[0, -1]].astype(np.float64) if len(points) > 1 else points.astype(np.float64)
    count = max(2, round(float(along[-1]) / spacing) + 1)
    places = np.linspace(0.0, along[-1], count)
    return np.stack((np.interp(places, along, points[:, 0]), np.interp(places, along, points[:, 1])), axis=-1)


def curvatures(points: Points, reach: int = 2) -> NDArray[np.float64]:
    """Signed curvature (n) in 1/m, left is positive.

    That of the circle through each point and those `reach` before and after it; ends take their neighbour's.
    """
    count = len(points)
    result = np.zeros(count)
    if count < 2 * reach + 1:
        return result
    a, b, c = points[: -2 * reach], points[reach:-reach], points[2 * reach :]
    ab, bc, ac = b - a, c - b, c - a
    cross = ab[:, 0] * bc[:, 1] - ab[:, 1] * bc[:, 0]
    lengths = np.hypot(*ab.T) * np.hypot(*bc.T) * np.hypot(*ac.T)
    result[reach:-reach] = 2.0 * cross / np.maximum(lengths, 1e-12)
    result[:reach], result[-reach:] = result[reach], result[-reach - 1]
    return result


def headings(points: Points) -> NDArray[np.float64]:
    """Return the direction (n) in rad of the path at each point; the last point has that of the one before."""
    if len(points) < 2:
        return np.zeros(len(points))
    steps = np.diff(points, axis=0)
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    return np.append(angles, angles[-1])


def nearest_index(points: Points, x: float, y: float, start: int = 0, stop: int | None = None) -> int:
    """The index of the point nearest to a place, among points[start:stop]."""
    part = points[start:stop]
    return start + int(np.argmin((part[:, 0] - x) ** 2 + (part[:, 1] - y) ** 2))
