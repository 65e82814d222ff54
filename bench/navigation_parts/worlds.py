"""The fixed goals of each world: x, y in m in the map, heading in degrees.

Drawn once at random: at least 0.32 m from any obstacle, 6 to 20 m of shortest way from one to the next (the first from
the start at the origin), any heading. Then rounded and written down.
"""

from __future__ import annotations

import math

import numpy as np
from bench.navigation_parts.geodesic import free_cells
from scipy.ndimage import label

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.grid import Grid

_ROOM = 0.05  # m beside the farthest corner of a robot that turns

Goal = tuple[float, float, float]

GOALS: dict[str, tuple[Goal, ...]] = {
    "maze": (
        (7.87, 1.53, -140),
        (2.03, 7.62, -160),
        (7.23, 10.63, 160),
        (2.03, 13.83, 40),
        (0.03, 1.68, 0),
        (6.08, 3.08, 60),
        (11.88, 13.83, 170),
        (7.18, 4.18, 10),
        (7.43, 13.38, 30),
        (10.83, 10.18, -100),
    ),
    "office": (
        (5.88, 6.47, 160),
        (8.03, -6.43, -120),
        (10.73, 1.47, -60),
        (14.28, 2.43, -140),
        (14.18, -5.22, 140),
        (8.48, -2.53, 120),
        (8.23, 4.22, 180),
        (13.93, -0.12, 10),
        (9.83, 3.22, -90),
        (12.28, -1.97, -30),
    ),
}

OBSTACLE_GOALS = (1, 4, 7)
"""The goals (from 0) during which an obstacle appears on the way, with --obstacles."""


def fit_goals(goals: tuple[Goal, ...], grid: Grid, footprint: Footprint) -> tuple[Goal, ...]:
    """Move goals at which the robot cannot turn, or to which it cannot get from the origin, to the next such place.

    Goals of robots that are no larger than those which the goals were drawn for stay as they are.
    """
    free = free_cells(grid, footprint.circumscribed + _ROOM)
    pieces, _ = label(free_cells(grid, footprint.inscribed + _ROOM))
    start = pieces[tuple(grid.cells_of_points(np.zeros(2)))]
    places = grid.points_of_cells(np.argwhere(free & (pieces == start) & (start > 0)))
    if not len(places):
        return goals
    fitted = []
    for x, y, heading in goals:
        distances = np.hypot(*(places - (x, y)).T)
        nearest = int(distances.argmin())
        if distances[nearest] > math.sqrt(0.5) * grid.resolution + 1e-6:
            x, y = (round(float(value), 2) for value in places[nearest])
        fitted.append((x, y, heading))
    return tuple(fitted)
