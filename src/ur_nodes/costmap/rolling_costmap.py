"""The local costmap: a window that rolls along with the robot, with the obstacles of the scan or of the map."""

import math

import numpy as np

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap, Inflation, inflate
from ur_nodes.costmap.layers import Beams, UsedRanges, shift_cells, trace_beams
from ur_nodes.geometry.pose import Pose2


class RollingCostmap:
    """A square window of side `side` (m) in the odometry frame, always aligned with whole cells of it.

    `behind` (m) is how far beyond the end of a ray an obstacle is marked. `touched` (n, 2) are obstacles that no ray
    clears, m.
    """

    def __init__(
        self, side: float, resolution: float, reach: UsedRanges, inflation: Inflation, behind: float = 0.0
    ) -> None:
        cells = max(4, round(side / resolution))
        self._resolution = resolution
        self._reach = reach
        self.inflation = inflation
        self._behind = behind
        self._occupied = np.zeros((cells, cells), bool)
        self._mapped = np.zeros((cells, cells), bool)
        self._corner: tuple[int, int] | None = None
        self.touched = np.empty((0, 2))

    def update(self, robot: Pose2, sensor: Pose2, beams: Beams) -> None:
        """Roll the window to the robot, then clear and mark with a scan taken from `sensor`; poses in its frame."""
        self._roll(robot)
        trace_beams(self._occupied, self._frame(), sensor, beams, self._reach, behind=self._behind)

    def overlay(self, robot: Pose2, known: Costmap, pose: Pose2) -> None:
        """Roll the window to the robot and take obstacles from a map that lies at `pose` in the window's frame.

        For a robot without a scan: what was laid before goes, and clearing leaves the map's obstacles.
        """
        self._roll(robot)
        frame = self._frame()
        centres = frame.points_of_cells(np.moveaxis(np.indices(self._mapped.shape), 0, -1))
        self._mapped = known.costs_at(pose.inverse().transform_points(centres), outside=FREE) == LETHAL

    def clear(self, keep: Pose2 | None = None, distance: float = 0.0) -> None:
        """Forget all obstacles, or those outside a square of half side `distance` round a place."""
        if keep is None or self._corner is None:
            self._occupied[:] = False
            return
        row, column = self._frame().fractions_of_points(np.array((keep.x, keep.y)))
        reach = distance / self._resolution
        rows = slice(max(0, math.floor(row - reach)), max(0, math.ceil(row + reach)))
        columns = slice(max(0, math.floor(column - reach)), max(0, math.ceil(column + reach)))
        kept = self._occupied[rows, columns].copy()
        self._occupied[:] = False
        self._occupied[rows, columns] = kept

    def occupied(self) -> Costmap:
        """The window with obstacles (254) and nothing else: what a footprint must not touch."""
        costs = (self._occupied | self._mapped).view(np.uint8) * np.uint8(LETHAL)  # others are FREE, 0
        frame = self._frame()
        cells = frame.cells_of_points(self.touched)
        costs[tuple(cells[frame.contains(cells)].T)] = LETHAL
        return Costmap(costs, frame.resolution, frame.origin)

    def inflated(self) -> Costmap:
        """The window with inflated obstacles, for display."""
        plain = self.occupied()
        return Costmap(inflate(plain.costs, plain.resolution, self.inflation), plain.resolution, plain.origin)

    def _roll(self, robot: Pose2) -> None:
        half = self._occupied.shape[0] // 2
        corner = (math.floor(robot.y / self._resolution) - half, math.floor(robot.x / self._resolution) - half)
        if self._corner is not None and corner != self._corner:
            self._occupied = shift_cells(self._occupied, corner[0] - self._corner[0], corner[1] - self._corner[1])
        self._corner = corner

    def _frame(self) -> Costmap:
        row, column = self._corner or (0, 0)
        origin = Pose2(column * self._resolution, row * self._resolution, 0.0)
        return Costmap(self._occupied.view(np.uint8), self._resolution, origin)
