"""Smoothing of a chain of cells: straight where possible, with wide turns elsewhere."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.ndimage import gaussian_filter

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths, resample

Weights = NDArray[np.float64]
"""The cost of a metre (256) for each cost of a cell, inf where the robot must not go."""

_SMALL = 300_000  # cells of a map that is worked out whole
_TILE = 64  # cells a side
_REACH = 12.0  # m: of a straight piece that is tried
_AROUND = 5  # cells round a tile that its values depend on


@dataclass(frozen=True, slots=True)
class Bending:
    """Parameters of smoothing: `stiffness` (m^2) makes turns wider, `spacing` (m) and `rounds` set the effort."""

    stiffness: float = 0.06
    spacing: float = 0.1
    rounds: int = 60


def pull_straight(points: Points, costmap: Costmap, weights: Weights) -> Points:
    """Return the path (n, 2) without the detours of its grid.

    Made of straight pieces of at most about 12 m each that cost no more than what they replace.
    """
    along = arc_lengths(points)
    each = _weights_at(points, costmap, weights)
    # As the search counts: between two free cells that touch at a corner, a sampled line could find a forbidden one.
    each[~np.isfinite(each)] = 1e3
    total = np.concatenate(((0.0,), np.cumsum(0.5 * (each[:-1] + each[1:]) * np.diff(along))))
    kept = [0]
    while kept[-1] < len(points) - 1:
        here = kept[-1]
        last = max(here + 1, int(np.searchsorted(along, along[here] + _REACH)))
        ends = np.unique(np.append(np.arange(here + 1, min(last, len(points) - 1) + 1, 3), min(last, len(points) - 1)))
        lines = _line_costs(np.repeat(points[here][None], len(ends), axis=0), points[ends], costmap, weights)
        gains = np.where(lines <= total[ends] - total[here] + 1e-9, ends, here + 1)
        kept.append(int(gains.max()))
    return points[kept]


def smooth(points: Points, costmap: Costmap, weights: Weights, bending: Bending) -> Points:
    """Return a path like `points` (n, 2) that bends gently and trades length against cost as the weights do; ends stay.

    Each round moves every point towards the shortest weighted path (curvature against the gradient of log weight,
    across the path only), held stiff by a bending energy; the internal forces are solved implicitly, as for active
    contours (Kass, Witkin, Terzopoulos 1988). Where the result would touch an obstacle, the input is returned.
    """
    path = resample(points, bending.spacing)
    if len(path) < 5:
        return path
    slope = Slopes(costmap, weights, path)
    count = len(path)
    step = 1.5 * bending.spacing**2
    factor = _internal(count, bending, step)
    for number in range(bending.rounds):
        if number % 10 == 9:
            path = resample_to(path, count)
        force = -_across(path, slope.at(path))
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


class Slopes:
    """The gradient, per m, of the logarithm of the weights round a path; 0 farther than about 3 m from it.

    A small map is worked out whole, a large one in tiles along the path.
    """

    def __init__(self, costmap: Costmap, weights: Weights, path: Points) -> None:
        self._costmap = costmap
        height, width = costmap.shape
        small = costmap.costs.size <= _SMALL
        self._tile = side = max(height, width) if small else _TILE
        tiles = (-(-height // side), -(-width // side))
        wanted = np.zeros(tiles, bool)
        places = np.clip(costmap.cells_of_points(path) // side, 0, np.array(tiles) - 1)
        for row in (-1, 0, 1):
            for column in (-1, 0, 1):
                near = np.clip(places + np.array((row, column)), 0, np.array(tiles) - 1)
                wanted[near[:, 0], near[:, 1]] = True
        self._number = np.full(tiles, -1, np.intp)
        self._number[wanted] = np.arange(int(wanted.sum()))
        finite = np.isfinite(weights)
        present = np.bincount(costmap.costs.reshape(-1), minlength=256) > 0 if small else np.ones(256, bool)
        top = float(weights[finite & present].max(initial=1.0)) * 1.5
        logs = np.log(np.where(finite, weights, top))
        parts = [self._work_out(logs, *tile) for tile in np.argwhere(wanted).tolist()]
        most = [max(part.shape[axis] for part in parts) for axis in (0, 1)]
        self._slopes = np.zeros((len(parts) + 1, *most, 2))  # the last one: where no tile is
        for place, part in zip(self._slopes, parts, strict=False):
            place[: part.shape[0], : part.shape[1]] = part

    def at(self, points: Points) -> Points:
        """The values (n, 2) at points (n, 2), between the cells' centres, in the costmap's frame."""
        costmap, side = self._costmap, self._tile
        height, width = costmap.shape
        places = costmap.fractions_of_points(points) - 0.5
        rows = np.clip(places[:, 0], 0, height - 1.001)
        columns = np.clip(places[:, 1], 0, width - 1.001)
        r, c = rows.astype(np.intp), columns.astype(np.intp)
        u, v = (rows - r)[:, None], (columns - c)[:, None]
        number = self._number[r // side, c // side]
        r, c = r % side, c % side
        slopes = self._slopes
        low = slopes[number, r, c] * (1 - v) + slopes[number, r, c + 1] * v
        high = slopes[number, r + 1, c] * (1 - v) + slopes[number, r + 1, c + 1] * v
        x, y = (low * (1 - u) + high * u).T
        cos, sin = np.cos(costmap.origin.yaw), np.sin(costmap.origin.yaw)
        return np.stack((cos * x - sin * y, sin * x + cos * y), axis=-1)

    def _work_out(self, logs: Weights, row: int, column: int) -> Points:
        """The slopes (rows, columns, 2) as (d/dx, d/dy) in the grid's axes of one tile and one more row and column."""
        top, left = row * self._tile, column * self._tile
        upper, before = min(top, _AROUND), min(left, _AROUND)
        beyond = self._tile + 1 + _AROUND
        part = logs[self._costmap.costs[top - upper : top + beyond, left - before : left + beyond]]
        rows, columns = np.gradient(gaussian_filter(part, 1.0), self._costmap.resolution)
        inner = slice(upper, upper + self._tile + 1), slice(before, before + self._tile + 1)
        return np.stack((columns[inner], rows[inner]), axis=-1)


def _line_costs(starts: Points, ends: Points, costmap: Costmap, weights: Weights) -> NDArray[np.float64]:
    """Return the costs of straight lines: length times mean weight, inf where one touches a forbidden cell."""
    lengths = np.hypot(*(ends - starts).T)
    count = max(2, int(np.ceil(lengths.max() / (0.5 * costmap.resolution))) + 1)
    shares = np.linspace(0.0, 1.0, count)
    points = starts[:, None] + shares[None, :, None] * (ends - starts)[:, None]
    means = _weights_at(points, costmap, weights).mean(axis=1)
    costs: NDArray[np.float64] = np.where(lengths > 0.0, means * lengths, 0.0)
    return costs


def _weights_at(points: NDArray[np.float64], costmap: Costmap, weights: Weights) -> NDArray[np.float64]:
    """The weights (...) of the cells below points (..., 2), of the nearest cell where they are outside."""
    cells = costmap.cells_of_points(points)
    height, width = costmap.shape
    rows, columns = np.clip(cells[..., 0], 0, height - 1), np.clip(cells[..., 1], 0, width - 1)
    below: NDArray[np.float64] = weights[costmap.costs[rows, columns]]
    return below
