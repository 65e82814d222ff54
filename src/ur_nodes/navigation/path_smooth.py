"""Smoothing of a chain of cells: straight where possible, with wide turns elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.ndimage import gaussian_filter

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.navigation.path_geometry import Points, arc_lengths, resample


@dataclass(frozen=True, slots=True)
class Bending:
    """Parameters of smoothing: `stiffness` (m^2) makes turns wider, `spacing` (m) and `rounds` set the effort."""

    stiffness: float = 0.06
    spacing: float = 0.1
    rounds: int = 60


def pull_straight(points: Points, costmap: Costmap, weights: NDArray[np.float64], reach: float = 12.0) -> Points:
    """Return the path (n, 2) without the detours of its grid.

    Made of straight pieces of at most about `reach` m each that cost no more than what they replace. `weights`
    (height, width) is the cost of a metre in each cell, inf where the path must not go.
    """
    along = arc_lengths(points)
    each = _weights_at(points, costmap, weights)
    # As the search counts: between two free cells that touch at a corner, a sampled line could find a forbidden one.
    each[~np.isfinite(each)] = 1e3
    total = np.concatenate(((0.0,), np.cumsum(0.5 * (each[:-1] + each[1:]) * np.diff(along))))
    kept = [0]
    while kept[-1] < len(points) - 1:
        here = kept[-1]
        last = max(here + 1, int(np.searchsorted(along, along[here] + reach)))
        ends = np.unique(np.append(np.arange(here + 1, min(last, len(points) - 1) + 1, 3), min(last, len(points) - 1)))
        lines = _line_costs(np.repeat(points[here][None], len(ends), axis=0), points[ends], costmap, weights)
        gains = np.where(lines <= total[ends] - total[here] + 1e-9, ends, here + 1)
        kept.append(int(gains.max()))
    return points[kept]


def smooth(points: Points, costmap: Costmap, weights: NDArray[np.float64], bending: Bending) -> Points:
    """Return a path like `points` (n, 2) that bends gently and trades length against cost as the weights do; ends stay.

    Each round moves every point towards the shortest weighted path (curvature against the gradient of log weight,
    across the path only), held stiff by a bending energy; the internal forces are solved implicitly, as for active
    contours (Kass, Witkin, Terzopoulos 1988). Where the result would touch an obstacle, the input is returned.
    """
    path = resample(points, bending.spacing)
    if len(path) < 5:
        return path
    slope = _log_gradient(weights, costmap.resolution)
    count = len(path)
    step = 1.5 * bending.spacing**2
    factor = _internal(count, bending, step)
    for number in range(bending.rounds):
        if number % 10 == 9:
            path = resample_to(path, count)
        force = -_across(path, _sample(slope, costmap, path))
        target = path + step * force
        inner = target[1:-1].copy()
        _add_ends(inner, path, bending, step)
        path[1:-1] = cho_solve_banded((factor, True), inner)
    costs = _line_costs(path[:-1], path[1:], costmap, weights)
    return path if np.isfinite(costs).all() else resample(points, bending.spacing)


def resample_to(points: Points, count: int) -> Points:
    """Resample a path with `count` even points."""
    along = arc_lengths(points)
    places = np.linspace(0.0, along[-1], count)
    return np.stack((np.interp(places, along, points[:, 0]), np.interp(places, along, points[:, 1])), axis=-1)


def _internal(count: int, bending: Bending, step: float) -> NDArray[np.float64]:
    """Cholesky factor of I + step (second differences + stiffness x fourth differences) for the inner points."""
    inner = count - 2
    a = step / bending.spacing**2
    b = step * bending.stiffness / bending.spacing**4
    bands = np.zeros((3, inner))
    bands[0] = 1.0 + 2.0 * a + 6.0 * b
    bands[0, [0, -1]] -= b  # free ends: no bending moment, the fourth difference becomes 5 -4 1
    bands[1, :-1] = -a - 4.0 * b
    bands[2, :-2] = b
    factor: NDArray[np.float64] = cholesky_banded(bands, lower=True)
    return factor


def _add_ends(inner: Points, path: Points, bending: Bending, step: float) -> None:
    a = step / bending.spacing**2
    b = step * bending.stiffness / bending.spacing**4
    inner[0] += (a + 2.0 * b) * path[0]
    inner[-1] += (a + 2.0 * b) * path[-1]
    if len(inner) > 1:
        inner[1] -= b * path[0]
        inner[-2] -= b * path[-1]


def _across(path: Points, vectors: Points) -> Points:
    tangents = np.gradient(path, axis=0)
    tangents /= np.maximum(np.hypot(*tangents.T), 1e-9)[:, None]
    result: Points = vectors - (vectors * tangents).sum(1)[:, None] * tangents
    return result


def _log_gradient(weights: NDArray[np.float64], resolution: float) -> NDArray[np.float64]:
    """The gradient (height, width, 2) as (d/dx, d/dy) per m, in the grid's axes, of the logarithm of the weights."""
    finite = np.isfinite(weights)
    top = float(weights[finite].max()) * 1.5 if finite.any() else 1.0
    logs = gaussian_filter(np.log(np.where(finite, weights, top)), 1.0)
    rows, columns = np.gradient(logs, resolution)
    return np.stack((columns, rows), axis=-1)


def _sample(slope: NDArray[np.float64], costmap: Costmap, points: Points) -> Points:
    """Bilinear values of the slope (height, width, 2) at points, turned into the costmap's frame."""
    height, width = slope.shape[:2]
    places = costmap.fractions_of_points(points) - 0.5
    rows = np.clip(places[:, 0], 0, height - 1.001)
    columns = np.clip(places[:, 1], 0, width - 1.001)
    r, c = rows.astype(np.intp), columns.astype(np.intp)
    u, v = (rows - r)[:, None], (columns - c)[:, None]
    low = slope[r, c] * (1 - v) + slope[r, c + 1] * v
    high = slope[r + 1, c] * (1 - v) + slope[r + 1, c + 1] * v
    x, y = (low * (1 - u) + high * u).T
    cos, sin = np.cos(costmap.origin.yaw), np.sin(costmap.origin.yaw)
    return np.stack((cos * x - sin * y, sin * x + cos * y), axis=-1)


def _line_costs(starts: Points, ends: Points, costmap: Costmap, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the costs of straight lines: length times mean weight, inf where one touches a forbidden cell."""
    lengths = np.hypot(*(ends - starts).T)
    count = max(2, int(np.ceil(lengths.max() / (0.5 * costmap.resolution))) + 1)
    shares = np.linspace(0.0, 1.0, count)
    points = starts[:, None] + shares[None, :, None] * (ends - starts)[:, None]
    means = _weights_at(points, costmap, weights).mean(axis=1)
    costs: NDArray[np.float64] = np.where(lengths > 0.0, means * lengths, 0.0)
    return costs


def _weights_at(points: NDArray[np.float64], costmap: Costmap, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """The weights (...) of the cells below points (..., 2), of the nearest cell where they are outside."""
    cells = costmap.cells_of_points(points)
    height, width = weights.shape
    below: NDArray[np.float64] = weights[np.clip(cells[..., 0], 0, height - 1), np.clip(cells[..., 1], 0, width - 1)]
    return below
