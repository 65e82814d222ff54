"""The pose graph: keyframes and what is known of their relative poses, made consistent by gtsam."""

from __future__ import annotations

import gtsam
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.surface import Floats

_LEVER = 4.0  # m: how far a turn is felt when an uncertainty is given as one length
_KERNEL = 2.0  # standard deviations beyond which a loop counts less and less
_FIXED = np.array((1e-4, 1e-4, 1e-4))


class PoseGraph:
    """Poses of keyframes 0, 1, 2, ... in the map; the first one stays where it is."""

    def __init__(self) -> None:
        self._graph = gtsam.NonlinearFactorGraph()
        self._values = gtsam.Values()
        self._ends: list[tuple[int, int]] = []
        self._costs: list[float] = []
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
        self._ends.append((before, after))
        self._costs.append(float(covariance[0, 0] + covariance[1, 1] + _LEVER**2 * covariance[2, 2]))

    def optimise(self) -> None:
        """Bring all poses to where they fit the edges best."""
        parameters = gtsam.LevenbergMarquardtParams()
        parameters.setMaxIterations(15)
        parameters.setRelativeErrorTol(1e-4)
        self._values = gtsam.LevenbergMarquardtOptimizer(self._graph, self._values, parameters).optimize()
        found = gtsam.utilities.extractPose2(self._values)
        self.poses = [Pose2(float(x), float(y), float(yaw)) for x, y, yaw in found]

    def spread_from(self, number: int, limit: float) -> NDArray[np.float64]:
        """How uncertain (m, one standard deviation) each pose is relative to one; inf beyond `limit`.

        The variances along the shortest path of edges are added up.
        """
        count = len(self.poses)
        if not self._ends:
            return np.where(np.arange(count) == number, 0.0, np.inf)
        best: dict[tuple[int, int], float] = {}
        for ends, cost in zip(self._ends, self._costs, strict=True):
            best[ends] = min(cost, best.get(ends, np.inf))
        rows, columns = np.array(list(best)).T
        table = csr_array((np.fromiter(best.values(), float), (rows, columns)), shape=(count, count))
        spread: NDArray[np.float64] = dijkstra(table, directed=False, indices=number, limit=limit * limit)
        return np.sqrt(spread)
