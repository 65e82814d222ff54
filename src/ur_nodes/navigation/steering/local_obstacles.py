"""Obstacles and people around the robot, for the local planner."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, TrackedPeople

Floats = NDArray[np.float64]


def _no_points() -> Floats:
    return np.empty((0, 2))


@dataclass(frozen=True, slots=True, eq=False)
class LocalObstacles:
    """Obstacles as cells of a costmap, points (n, 2) in their place, and people, in the odometry frame.

    `scan` (n, 2) are the points where the newest scan ends, as long as cells stand for them.
    """

    costmap: Costmap
    people: TrackedPeople = NO_PEOPLE
    points: Floats = field(default_factory=_no_points)
    scan: Floats = field(default_factory=_no_points)

    def exact(self) -> LocalObstacles:
        """Return the obstacles with the scan's points in place of the cells that they explain: cells are coarse."""
        if not len(self.scan):
            return self
        return LocalObstacles(without_points(self.costmap, self.scan), self.people, self.scan)


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
