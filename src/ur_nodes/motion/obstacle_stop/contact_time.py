"""The time until a robot's outline meets points while it drives along an arc, exactly.

All points are in the base's frame in m; velocities in m/s and rad/s.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.hull import Hull

Floats = NDArray[np.float64]

_STRAIGHT = 1e-6  # rad/s: slower turns are none
_LEAST = 1e-4  # m: a motion that brings a touched point nearer than this meets it
_ROUNDING = 1e-9


def time_to_contact(
    hull: Hull, points: Floats, margin: float, velocity: tuple[float, float], horizon: float, left: float = 0.0
) -> tuple[float, int]:
    """The time (s) until the outline, `margin` (m) wider, meets the first of some points (n, 2), and which one.

    Infinite, and -1, when it meets none within `horizon` s of driving with `velocity` (forward, turn) and to the
    `left` (m/s). A point that is
    nearer than the margin already is met at once by a motion that brings it nearer, and never by one that does not.
    """
    forward, turn = velocity
    margins = np.minimum(margin, hull.distances(points) - _LEAST) if len(points) else np.empty(0)
    if not len(points):
        return math.inf, -1
    times = _arc(hull, points, margins, (forward, left), turn, horizon) if abs(turn) > _STRAIGHT else None
    if times is None:
        times = _straight(hull, points, margins, (forward, left))
    first = int(np.argmin(times))
    return (float(times[first]), first) if times[first] <= horizon else (math.inf, -1)


def _straight(hull: Hull, points: Floats, margins: Floats, along: tuple[float, float]) -> Floats:
    """Return times (n) for straight motion: the interval in which a point is within the half-planes of all edges."""
    outside = points @ hull.normals.T - hull.offsets - margins[:, None]  # (n, edges)
    rates = -along[0] * hull.normals[:, 0]
    if along[1]:
        rates = rates - along[1] * hull.normals[:, 1]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crossings = -outside / rates
    enters = np.where(rates < -_ROUNDING, crossings, -np.inf).max(axis=1)
    leaves = np.where(rates > _ROUNDING, crossings, np.inf).min(axis=1)
    beside = ((np.abs(rates) <= _ROUNDING) & (outside > 0.0)).any(axis=1)
    times: Floats = np.where(~beside & (enters <= leaves) & (enters >= 0.0), enters, np.inf)
    return times


def _arc(
    hull: Hull, points: Floats, margins: Floats, along: tuple[float, float], turn: float, horizon: float
) -> Floats:
    """Return times (n) for an arc: in the robot's frame, each point moves on a circle about the centre of the arc."""
    centre = np.array((-along[1] / turn, along[0] / turn))
    spokes = points - centre
    radii = np.hypot(*spokes.T)[:, None]
    phases = np.arctan2(
        spokes[:, 1, None] * hull.normals[:, 0] - spokes[:, 0, None] * hull.normals[:, 1], spokes @ hull.normals.T
    )  # (n, edges): the distance to an edge is radius * cos(angle - phase) + base
    base = hull.normals @ centre - hull.offsets
    bounds = margins[:, None] - base  # (n, edges)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = bounds / radii
        angles = math.copysign(1.0, turn) * phases + np.arccos(ratios)  # nan: this edge is never crossed
    times = (angles % (2.0 * math.pi)) / abs(turn)
    rows, columns = np.nonzero(times <= horizon)  # false for nan
    at = turn * times[rows, columns]
    meets = (radii[rows] * np.cos(at[:, None] - phases[rows]) <= bounds[rows] + _ROUNDING).all(axis=1)
    first = np.full(len(points), np.inf)
    np.minimum.at(first, rows[meets], times[rows, columns][meets])
    return first
