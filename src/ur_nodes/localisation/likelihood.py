"""The likelihood field: how near the end of a beam is to a wall of the map, and how likely that makes a scan.

Source: Thrun, Burgard, Fox, Probabilistic Robotics, section 6.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.geometry.grid import FREE, Grid

OCCUPIED_FROM = 65  # of 100: what counts as a wall in maps with values between


@dataclass(frozen=True, slots=True)
class BeamModel:
    """The model of a range: shares of hits and of random readings, spread `sigma_hit` and upper limit in m."""

    z_hit: float
    z_rand: float
    sigma_hit: float
    max_distance: float


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodField:
    """A map, prepared for localisation.

    `distances` float32 (height, width), m: from a cell's centre to the nearest wall's surface, negative inside walls,
    at most `model.max_distance`; +max_distance everywhere on a map without walls. `log_hits` float32, same shape: the
    logarithm of a beam's likelihood when it ends in that cell; both have a border of one cell that represents
    everything outside. `free` intp (n, 2): the (row, column) of every free cell of `grid`.
    """

    grid: Grid
    model: BeamModel
    distances: NDArray[np.float32]
    log_hits: NDArray[np.float32]
    free: NDArray[np.intp]


def make_field(grid: Grid, model: BeamModel) -> LikelihoodField:
    """The likelihood field of a grid; cells of at least 65 are walls. The ends of beams outside the grid are random."""
    walls = grid.values >= OCCUPIED_FROM
    exact = np.pad(signed_distances(walls, grid.resolution), 1, constant_values=model.max_distance)
    distances: NDArray[np.float32] = np.clip(exact, -model.max_distance, model.max_distance).astype(np.float32)
    log_hits = log_likelihoods(np.maximum(distances, 0.0), model).astype(np.float32)
    return LikelihoodField(grid, model, distances, log_hits, np.argwhere(grid.values == FREE))


def signed_distances(walls: NDArray[np.bool_], resolution: float) -> NDArray[np.float64]:
    """From each cell's centre (height, width) to the nearest wall surface in m, negative inside; inf without walls.

    Half a cell is taken off the distance between centres, so that the value is 0 on the edge between a wall cell and
    its free neighbour and changes evenly across it.
    """
    if not walls.any():
        return np.full(walls.shape, math.inf)
    outside = distance_transform_edt(~walls)
    inside = distance_transform_edt(walls)
    cells: NDArray[np.float64] = np.where(walls, 0.5 - inside, outside - 0.5)
    return cells * resolution


def log_likelihoods(distances: NDArray[np.floating], model: BeamModel) -> NDArray[np.float64]:
    """Log of the likelihood of beams that end so far (m) from a wall, 0 for a sure hit, bounded below by z_rand."""
    hit = model.z_hit * np.exp(-0.5 * np.square(distances / model.sigma_hit))
    floor = max(model.z_rand, 1e-6)
    result: NDArray[np.float64] = np.log((hit + floor) / (model.z_hit + floor))
    return result


def score_poses(
    field: LikelihoodField,
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
    table: NDArray[np.float32] | None = None,
) -> NDArray[np.float64]:
    """The mean log likelihood (n) per beam of poses (n, 3), when beams end at points (m, 2) in the robot's frame.

    With `table`, shaped like `field.log_hits`, the mean of its entries instead.
    """
    entries = field.log_hits if table is None else table
    grid = field.grid
    scale = 1.0 / grid.resolution
    yaws = (poses[:, 2] - grid.origin.yaw).astype(np.float32)
    # In float32 and cells throughout: this is where the time goes, and 1e-7 of a map is far below a cell.
    base = grid.fractions_of_points(poses[:, :2]).astype(np.float32) + np.float32(1.0)  # 1: the border
    c, s = np.cos(yaws)[:, None], np.sin(yaws)[:, None]
    along, across = (points * scale).astype(np.float32).T
    columns = (base[:, 1:] + c * along - s * across).astype(np.int32)
    rows = (base[:, :1] + s * along + c * across).astype(np.int32)
    height, width = entries.shape
    np.clip(columns, 0, width - 1, out=columns)
    np.clip(rows, 0, height - 1, out=rows)
    rows *= width
    rows += columns
    scores: NDArray[np.float64] = entries.ravel().take(rows).mean(axis=1, dtype=np.float64)
    return scores


def draw_free_poses(field: LikelihoodField, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw poses (count, 3) on free cells, with any heading. The map must have a free cell."""
    cells = field.free[rng.integers(len(field.free), size=count)] + rng.random((count, 2)) - 0.5
    yaws = rng.uniform(-math.pi, math.pi, count)
    return np.column_stack((field.grid.points_of_cells(cells), yaws))
