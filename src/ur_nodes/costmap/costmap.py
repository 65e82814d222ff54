"""Costs of driving: one byte per cell, with the meaning that costmap_2d gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.geometry.grid import CellFrame, Grid, look_up
from ur_nodes.geometry.pose import Pose2

FREE = 0
INSCRIBED = 253
LETHAL = 254
UNKNOWN = 255


@dataclass(frozen=True, slots=True)
class Inflation:
    """Decay of costs around obstacles: radii in m, `scaling` in 1/m."""

    inscribed: float
    radius: float
    scaling: float


@dataclass(frozen=True, slots=True, eq=False)
class Costmap(CellFrame):
    """Costs (height, width) uint8: 254 an obstacle, 253 the robot would touch one, 252 to 0 ever farther, 255 unknown.

    `origin` is a pose in the frame of the costmap, `resolution` is in m.
    """

    costs: NDArray[np.uint8]
    resolution: float
    origin: Pose2

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of rows and columns."""
        height, width = self.costs.shape
        return height, width

    def costs_at(self, points: NDArray[np.floating], outside: int = UNKNOWN) -> NDArray[np.uint8]:
        """The costs (...) below points (..., 2) in m; `outside` beyond the border."""
        return look_up(self, self.costs, points, outside)


def costs_of_grid(grid: Grid, *, lethal: int = 100, track_unknown: bool = True) -> NDArray[np.uint8]:
    """The static layer: the obstacles of a map.

    Values from `lethal` up are obstacles, -1 is unknown (free, unless unknown space is tracked), others are free.
    """
    costs = np.where(grid.values >= lethal, np.uint8(LETHAL), np.uint8(FREE))
    if track_unknown:
        costs[grid.values < 0] = UNKNOWN
    result: NDArray[np.uint8] = costs.astype(np.uint8)
    return result


def inflation_costs(distances: NDArray[np.floating], inflation: Inflation) -> NDArray[np.uint8]:
    """Costs at distances in m from the nearest obstacle cell (centre to centre).

    costmap_2d's formula: 254 at 0, 253 up to the inscribed radius, then 252 exp(-scaling (d - inscribed)), rounded
    down; 0 beyond the inflation radius. (wiki.ros.org/costmap_2d, "Inflation")
    """
    costs = 252.0 * np.exp(-inflation.scaling * (distances - inflation.inscribed))
    costs[distances > inflation.radius] = 0.0
    costs[distances <= inflation.inscribed] = INSCRIBED
    costs[distances <= 0.0] = LETHAL
    result: NDArray[np.uint8] = costs.astype(np.uint8)
    return result


def inflate(costs: NDArray[np.uint8], resolution: float, inflation: Inflation) -> NDArray[np.uint8]:
    """The inflation layer: costs (height, width) with a slope round every obstacle.

    Unknown stays unknown unless the robot standing there would touch an obstacle; no cost is lowered.
    """
    lethal = costs == LETHAL
    if not lethal.any():
        return np.array(costs)
    distances = distance_transform_edt(~lethal) * resolution
    slope = inflation_costs(distances, inflation)
    unknown = costs == UNKNOWN
    raised = np.maximum(slope, np.where(unknown, np.uint8(0), costs))
    result: NDArray[np.uint8] = np.where(unknown & (slope < INSCRIBED), np.uint8(UNKNOWN), raised).astype(np.uint8)
    return result


def inflate_window(
    master: NDArray[np.uint8],
    costs: NDArray[np.uint8],
    resolution: float,
    inflation: Inflation,
    box: tuple[slice, slice],
) -> None:
    """As inflate, but only for what changes when `costs` changed inside `box` (rows, columns): updates `master`."""
    reach = math.ceil(max(inflation.radius, inflation.inscribed) / resolution) + 1
    inner = _grown(box, reach, costs.shape)
    outer = _grown(inner, reach, costs.shape)
    part = inflate(costs[outer], resolution, inflation)
    rows = slice(inner[0].start - outer[0].start, inner[0].stop - outer[0].start)
    columns = slice(inner[1].start - outer[1].start, inner[1].stop - outer[1].start)
    master[inner] = part[rows, columns]


def occupancy_of_costs(costs: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Costs as a nav_msgs/OccupancyGrid shows them: 100 obstacle, 99 inscribed, 98 to 0 below, -1 unknown."""
    occupancy: NDArray[np.int8] = _OCCUPANCY[costs]
    return occupancy


def _occupancy_table() -> NDArray[np.int8]:
    table = np.zeros(256, np.int8)
    table[1:INSCRIBED] = 1 + (97 * (np.arange(1, INSCRIBED) - 1)) // 251
    table[INSCRIBED], table[LETHAL], table[UNKNOWN] = 99, 100, -1
    return table


_OCCUPANCY = _occupancy_table()


def _grown(box: tuple[slice, slice], by: int, shape: tuple[int, ...]) -> tuple[slice, slice]:
    rows, columns = box
    return (
        slice(max(0, rows.start - by), min(shape[0], rows.stop + by)),
        slice(max(0, columns.start - by), min(shape[1], columns.stop + by)),
    )
