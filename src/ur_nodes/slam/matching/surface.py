"""Scans as pieces of surface: the points where beams end, and the normals of the surfaces there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

Floats = NDArray[np.float64]

_WINDOW = 8  # beams to either side that a line is fitted to
_REACH = 0.25  # m: as far as these may lie from the middle one,
_BEAMS = 3.0  # and so many times the distance to the next beam, where that is more
_FARTHEST = 1.0  # m: beams farther apart are taken for so far apart
_NARROW = 0.08  # variance across a line over that along it, up to which the points count as one


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Points (n, 2) in m, unit normals (n, 2) towards the lidar, and `flat` (n): whether the normal can be trusted.

    `spacing` (n) is how far apart neighbouring beams are there, across the beams, m.
    """

    points: Floats
    normals: Floats
    flat: NDArray[np.bool_]
    spacing: Floats

    def __len__(self) -> int:
        return len(self.points)

    def moved(self, pose: Pose2) -> Surface:
        """Express the surface in the parent frame of `pose`."""
        c, s = np.cos(pose.yaw), np.sin(pose.yaw)
        turn = np.array(((c, s), (-s, c)))
        return Surface(self.points @ turn + (pose.x, pose.y), self.normals @ turn, self.flat, self.spacing)

    def sample(self, least: int) -> Floats:
        """Return points (n, 2) evenly spread over the scan: at least this many and less than twice as many, or all."""
        return self.points[:: max(1, len(self) // least)]

    def thinned(self, most: int) -> Surface:
        """Keep at most so many points, evenly spread over the scan."""
        step = -(-len(self) // most) if most else 1
        if step <= 1:
            return self
        return Surface(self.points[::step], self.normals[::step], self.flat[::step], self.spacing[::step])


def join(surfaces: list[Surface]) -> Surface:
    """Join all points of surfaces in the same frame; at least one surface."""
    return Surface(
        np.concatenate([each.points for each in surfaces]),
        np.concatenate([each.normals for each in surfaces]),
        np.concatenate([each.flat for each in surfaces]),
        np.concatenate([each.spacing for each in surfaces]),
    )


def surface_of_points(points: Floats, numbers: NDArray[np.intp], origin: Floats, step: int = 1) -> Surface:
    """Make a surface from the ends (n, 2) of beams, in the order of their `numbers` (n), seen from `origin` (2).

    A line is fitted to the neighbours of each point; of the points, every `step`-th is taken.
    """
    count = len(points)
    chosen = np.arange(0, count, step)
    places = chosen[:, None] + np.arange(-_WINDOW, _WINDOW + 1)
    inside = (places >= 0) & (places < count)
    places = np.clip(places, 0, max(0, count - 1))
    delta = points[places] - points[chosen, None]
    near = inside & (np.abs(numbers[places] - numbers[chosen, None]) <= _WINDOW)
    spacing = beam_spacing(points, numbers, origin)[chosen]
    near &= np.square(delta).sum(axis=2) <= np.square(np.maximum(_REACH, _BEAMS * spacing))[:, None]
    directions, flat = fit_lines(delta, near.astype(np.float64))[1:]
    return Surface(points[chosen], face(directions, origin - points[chosen]), flat, spacing)


def beam_spacing(points: Floats, numbers: NDArray[np.intp], origin: Floats) -> Floats:
    """Return the distance (n) in m between neighbouring beams at their ends (n, 2), across the beams."""
    away = points - origin
    steps = np.diff(numbers)
    turns = np.diff(np.arctan2(away[:, 1], away[:, 0]))
    usual = (steps > 0) & (steps <= _WINDOW) & (np.abs(turns) < np.pi)
    if not usual.any():
        return np.zeros(len(points))
    between = float(np.median(np.abs(turns[usual]) / steps[usual]))
    return np.minimum(_FARTHEST, between * np.hypot(away[:, 0], away[:, 1]))


def fit_lines(delta: Floats, weights: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Fit a line to each of n sets of k points (n, k, 2), with weights (n, k).

    Returns a point (n, 2) on each line, its unit normals (n, 2) of either sign, and for each whether it is one.
    """
    total = np.maximum(weights.sum(axis=1), 1e-9)
    mean: Floats = np.einsum("nk,nkd->nd", weights, delta) / total[:, None]
    away = delta - mean[:, None]
    weighted = weights / total[:, None]
    xx = (weighted * away[..., 0] ** 2).sum(axis=1)
    yy = (weighted * away[..., 1] ** 2).sum(axis=1)
    xy = (weighted * away[..., 0] * away[..., 1]).sum(axis=1)
    angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    spread = np.hypot(0.5 * (xx - yy), xy)
    along, across = 0.5 * (xx + yy) + spread, 0.5 * (xx + yy) - spread
    flat = ((weights > 0.0).sum(axis=1) >= 4) & (across < _NARROW * along)
    return mean, np.column_stack((-np.sin(angle), np.cos(angle))), flat


def face(normals: Floats, towards: Floats) -> Floats:
    """Turn normals (n, 2) round that point away from `towards` (n, 2)."""
    away = (normals * towards).sum(axis=1) < 0.0
    return np.where(away[:, None], -normals, normals)
