"""Obstacles and people around the robot, for the local planner."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, TrackedPeople

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LocalObstacles:
    """Obstacles as cells of a costmap, points (n, 2) where the newest scan ends, and people, in the odometry frame.

    Cells that the points explain are removed from the costmap: a point is more exact.
    """

    costmap: Costmap
    people: TrackedPeople = NO_PEOPLE
    points: Floats = field(default_factory=lambda: np.empty((0, 2)))


def without_points(costmap: Costmap, points: Floats) -> Costmap:
    """Return the costmap without the obstacles in the cells of points (n, 2), and in neighbouring cells."""
    cells = costmap.cells_of_points(points)
    costs = costmap.costs.copy()
    height, width = costs.shape
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            rows, columns = cells[:, 0] + down, cells[:, 1] + right
            inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            costs[rows[inside], columns[inside]] = FREE
    kept = np.minimum(costs, np.uint8(LETHAL))
    return Costmap(kept, costmap.resolution, costmap.origin)
