"""The pose graph: keyframes and what is known of their relative poses, made consistent by gtsam."""

from __future__ import annotations

import math
from collections.abc import Sequence

import gtsam
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.edge import Edge
from ur_nodes.slam.surface import Floats

_TURN = 16.0  # m^2: how much the variance of a turn counts when paths are compared
_KERNEL = 2.0  # standard deviations beyond which a loop counts less and less
_FIXED = np.array((1e-4, 1e-4, 1e-4))


class PoseGraph:
    """Poses of keyframes 0, 1, 2, ... in the map; the first one stays where it is."""

    def __init__(self) -> None:
        self._graph = gtsam.NonlinearFactorGraph()
        self._values = gtsam.Values()
        self._edges: list[Edge] = []
        self._ends: list[tuple[int, int]] = []
        self._costs: list[tuple[float, float, float]] = []  # variances of shift and turn, and the length, of each edge
        self.poses: list[Pose2] = []

    def add_pose(self, pose: Pose2) -> int:
        """Add a keyframe; returns its number. Without an edge to it, it is an error to optimise."""
        number = len(self.poses)
        self.poses.append(pose)
        self._values.insert(number, gtsam.Pose2(*pose))
        if number == 0:
            model = gtsam.noiseModel.Diagonal.Sigmas(_FIXED)
            self._graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*pose), model))
        return number

    def add_edge(self, before: int, after: int, relative: Pose2, covariance: Floats, *, robust: bool) -> None:
        """Say where one keyframe is in another's frame, with a covariance (3, 3); robust: unless others contradict."""
        model: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(covariance)
        if robust:
            model = gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(_KERNEL), model)
        self._graph.add(gtsam.BetweenFactorPose2(before, after, gtsam.Pose2(*relative), model))
        self._edges.append(Edge(before, after, relative, covariance, robust))
        self._ends.append((before, after))
        length = math.hypot(relative.x, relative.y)
        self._costs.append((float(covariance[0, 0] + covariance[1, 1]), float(covariance[2, 2]), length))

    @property
    def edges(self) -> Sequence[Edge]:
        """All edges, in the order in which they were added."""
        return self._edges

    def optimise(self) -> None:
        """Bring all poses to where they fit the edges best."""
        parameters = gtsam.LevenbergMarquardtParams()
        parameters.setMaxIterations(15)
        parameters.setRelativeErrorTol(1e-4)
        self._values = gtsam.LevenbergMarquardtOptimizer(self._graph, self._values, parameters).optimize()
        found = gtsam.utilities.extractPose2(self._values)
        self.poses = [Pose2(float(x), float(y), float(yaw)) for x, y, yaw in found]

    def spread_from(self, number: int, limit: float) -> NDArray[np.float64]:
        """Compute the uncertainty (m, one standard deviation) of each pose relative to one; inf beyond `limit`.

        The variances of shifts along the path of edges with the least of them are added up; those of turns, too, and
        felt at its end as those of a random walk: by a third of the square of its length.
        """
        count = len(self.poses)
        if not self._ends:
            return np.where(np.arange(count) == number, 0.0, np.inf)
        best: dict[tuple[int, int], tuple[float, float, float]] = {}
        for ends, (shift, turn, length) in zip(self._ends, self._costs, strict=True):
            if ends not in best or shift + _TURN * turn < best[ends][0] + _TURN * best[ends][1]:
                best[ends] = (shift, turn, length)
        rows, columns = np.array(list(best)).T
        costs = np.array(list(best.values()))
        sums = []
        for values in costs.T:
            table = csr_array((np.maximum(values, 1e-12), (rows, columns)), shape=(count, count))
            sums.append(dijkstra(table, directed=False, indices=number))
        spread: NDArray[np.float64] = np.sqrt(sums[0] + sums[1] * np.square(sums[2]) / 3.0)
        return np.where(spread <= limit, spread, np.inf)
