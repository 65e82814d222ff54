"""Costs of driving: one byte per cell, with the meaning that costmap_2d gives them."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur.worlds.cells import translate_cells
from ur_nodes.geometry.distance import squared_distances, strips
from ur_nodes.geometry.grid import CellFrame, Grid, look_up
from ur_nodes.geometry.pose import Pose2

Box = tuple[slice, slice]
"""Rows and columns of a part of a grid, with both ends."""

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
    values = np.arange(256, dtype=np.uint8).view(np.int8)
    table = np.where(values >= lethal, np.uint8(LETHAL), np.uint8(FREE)).astype(np.uint8)
    if track_unknown:
        table[values < 0] = UNKNOWN
    return translate_cells(grid.values, table)


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

    Unknown stays unknown unless the robot there would touch an obstacle; no cost is lowered.
    """
    reach = reach_of(inflation, resolution)
    squares = np.arange((reach + 1) ** 2 + reach**2 + 1)
    slopes = inflation_costs(np.sqrt(squares) * resolution, inflation)
    result = np.empty_like(costs)
    for strip, around, inner in strips(costs.shape, reach):
        lethal = costs[around] == LETHAL
        if not lethal.any():
            result[strip] = costs[strip]
            continue
        slope = slopes.take(squared_distances(lethal, reach)[inner], mode="clip")
        here = costs[strip]
        unknown = here == UNKNOWN
        raised = np.maximum(slope, np.where(unknown, np.uint8(0), here))
        result[strip] = np.where(unknown & (slope < INSCRIBED), np.uint8(UNKNOWN), raised)
    return result


def reach_of(inflation: Inflation, resolution: float) -> int:
    """The distance in cells that an obstacle changes costs up to."""
    return math.ceil(max(inflation.radius, inflation.inscribed) / resolution) + 1


def inflate_window(
    master: NDArray[np.uint8],
    costs: Callable[[Box], NDArray[np.uint8]],
    resolution: float,
    inflation: Inflation,
    box: Box,
) -> Box:
    """As inflate, but only for what changes when the costs changed inside `box`: updates `master`.

    `costs` gives the costs inside a box. Returns the box of the cells that may have changed.
    """
    reach = reach_of(inflation, resolution)
    inner = grown(box, reach, master.shape)
    outer = grown(inner, reach, master.shape)
    part = inflate(costs(outer), resolution, inflation)
    rows = slice(inner[0].start - outer[0].start, inner[0].stop - outer[0].start)
    columns = slice(inner[1].start - outer[1].start, inner[1].stop - outer[1].start)
    master[inner] = part[rows, columns]
    return inner


def occupancy_of_costs(costs: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Costs as a nav_msgs/OccupancyGrid shows them: 100 obstacle, 99 inscribed, 98 to 0 below, -1 unknown."""
    return translate_cells(costs, _OCCUPANCY)


def _occupancy_table() -> NDArray[np.int8]:
    table = np.zeros(256, np.int8)
    table[1:INSCRIBED] = 1 + (97 * (np.arange(1, INSCRIBED) - 1)) // 251
    table[INSCRIBED], table[LETHAL], table[UNKNOWN] = 99, 100, -1
    return table


_OCCUPANCY = _occupancy_table()


def grown(box: Box, by: int, shape: tuple[int, ...]) -> Box:
    """Return a box with `by` more cells on each side, as far as the grid goes."""
    rows, columns = box
    return (
        slice(max(0, rows.start - by), min(shape[0], rows.stop + by)),
        slice(max(0, columns.start - by), min(shape[1], columns.stop + by)),
    )


def joined(box: Box | None, other: Box) -> Box:
    """Return the smallest box round two."""
    if box is None:
        return other
    return (
        slice(min(box[0].start, other[0].start), max(box[0].stop, other[0].stop)),
        slice(min(box[1].start, other[1].start), max(box[1].stop, other[1].stop)),
    )
