"""The convex outline of a robot, and the time until it meets points while it drives along an arc, exactly.

Distances are those of the outline moved outward edge by edge: exact along edges, at a corner at most the true distance.
All points are in the base's frame in m; velocities in m/s and rad/s.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_STRAIGHT = 1e-6  # rad/s: slower turns are none
_LEAST = 1e-4  # m: a motion that brings a touched point nearer than this meets it
_ROUNDING = 1e-9


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
    corners = np.array(_convex(sorted(set(outline))), dtype=np.float64)
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack((edges[:, 1], -edges[:, 0])) / np.hypot(*edges.T)[:, None]
    return Hull(corners, normals, (normals * corners).sum(axis=1), float(np.hypot(*corners.T).max()))


def _convex(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Corners of the convex hull of sorted points, counter-clockwise (Andrew's monotone chain)."""
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
    return chains[0] + chains[1]


def time_to_contact(
    hull: Hull, points: Floats, margin: float, velocity: tuple[float, float], horizon: float
) -> tuple[float, int]:
    """The time (s) until the outline, `margin` (m) wider, meets the first of some points (n, 2), and which one.

    Infinite, and -1, when it meets none within `horizon` s of driving with `velocity` (forward, turn). A point that is
    nearer than the margin already is met at once by a motion that brings it nearer, and never by one that does not.
    """
    forward, turn = velocity
    margins = np.minimum(margin, hull.distances(points) - _LEAST) if len(points) else np.empty(0)
    if not len(points):
        return math.inf, -1
    times = _arc(hull, points, margins, forward, turn, horizon) if abs(turn) > _STRAIGHT else None
    if times is None:
        times = _straight(hull, points, margins, forward)
    first = int(np.argmin(times))
    return (float(times[first]), first) if times[first] <= horizon else (math.inf, -1)


def _straight(hull: Hull, points: Floats, margins: Floats, forward: float) -> Floats:
    """Times (n): the point stays within the half-plane of every edge from one moment to another."""
    outside = points @ hull.normals.T - hull.offsets - margins[:, None]  # (n, edges)
    rates = -forward * hull.normals[:, 0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crossings = -outside / rates
    enters = np.where(rates < -_ROUNDING, crossings, -np.inf).max(axis=1)
    leaves = np.where(rates > _ROUNDING, crossings, np.inf).min(axis=1)
    beside = ((np.abs(rates) <= _ROUNDING) & (outside > 0.0)).any(axis=1)
    times: Floats = np.where(~beside & (enters <= leaves) & (enters >= 0.0), enters, np.inf)
    return times


def _arc(hull: Hull, points: Floats, margins: Floats, forward: float, turn: float, horizon: float) -> Floats:
    """Times (n): seen from the robot, each point runs on a circle about the centre of the arc."""
    centre = np.array((0.0, forward / turn))
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
