"""The pose graph: keyframes and edges between them, optimised by gtsam.

Source of the incremental solution: Kaess et al., iSAM2: incremental smoothing and mapping using the Bayes tree, 2012.
"""

import math
from collections.abc import Sequence

import gtsam
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.map_state import Edge
from ur_nodes.slam.matching.surface import Floats

_TURN = 16.0  # m^2: how much the variance of a turn counts when paths are compared
_KERNEL = 2.0  # standard deviations beyond which a loop counts less and less
_CONFIRMED_KERNEL = 12.0  # likewise, of one that another has confirmed: drift may be many times what was expected
_FIXED = np.array((1e-4, 1e-4, 1e-4))
_RELINEARISED = 0.002  # m and rad from where an edge was linearised: then it is again
_SETTLED = 0.001  # m and rad: a step that moves no pose farther is the last one
_STEPS = 15


class PoseGraph:
    """Poses of keyframes 0, 1, 2, ... in the map; the first one is fixed."""

    def __init__(self) -> None:
        parameters = gtsam.ISAM2Params()
        parameters.setRelinearizeThreshold(_RELINEARISED)
        parameters.relinearizeSkip = 1
        self._smoother = gtsam.ISAM2(parameters)
        self._new_factors = gtsam.NonlinearFactorGraph()
        self._new_values = gtsam.Values()
        self._steps = 0  # that are left at most
        self._edges: list[Edge] = []
        self._best: dict[tuple[int, int], tuple[float, float]] = {}  # variances of shift and turn
        self._table: csr_array | None = None  # of the shifts, as a matrix
        self.poses: list[Pose2] = []

    def add_pose(self, pose: Pose2) -> int:
        """Add a keyframe; returns its number. Without an edge to it, it is an error to optimise."""
        number = len(self.poses)
        self.poses.append(pose)
        self._new_values.insert(number, gtsam.Pose2(*pose))
        if number == 0:
            model = gtsam.noiseModel.Diagonal.Sigmas(_FIXED)
            self._new_factors.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*pose), model))
        self._table = None
        return number

    def add_edge(
        self, before: int, after: int, relative: Pose2, covariance: Floats, *, robust: bool, confirmed: bool = False
    ) -> None:
        """Add a keyframe's pose in another's frame, with a covariance (3, 3).

        `robust`: unless others contradict. A pull that fades with the distance closes no loop whose ends have drifted
        far apart; that of a `confirmed` edge fades later.
        """
        model: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(covariance)
        if robust:
            kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(_CONFIRMED_KERNEL if confirmed else _KERNEL)
            model = gtsam.noiseModel.Robust.Create(kernel, model)
        self._new_factors.add(gtsam.BetweenFactorPose2(before, after, gtsam.Pose2(*relative), model))
        self._edges.append(Edge(before, after, relative, covariance, robust))
        shift, turn = float(covariance[0, 0] + covariance[1, 1]), float(covariance[2, 2])
        ends = min(before, after), max(before, after)
        known = self._best.get(ends)
        if known is None or shift + _TURN * turn < known[0] + _TURN * known[1]:
            self._best[ends] = (shift, turn)
            self._table = None

    @property
    def edges(self) -> Sequence[Edge]:
        """All edges, in the order in which they were added."""
        return self._edges

    def optimise(self) -> None:
        """Optimise all poses."""
        self.begin()
        while self.step():
            pass

    @property
    def unsettled(self) -> bool:
        """Return whether `step` would still move poses."""
        return self._steps > 0

    def begin(self, steps: int = _STEPS) -> None:
        """Start an optimisation that the next calls of `step`, this many at most, perform."""
        self._steps = max(self._steps, steps)

    def step(self) -> bool:
        """Optimise the poses further, in a time that grows with the number that move.

        Returns whether any has moved; False: the optimum is reached, or as near as possible.
        """
        if not self._steps:
            return False
        self._steps -= 1
        self._smoother.update(self._new_factors, self._new_values)
        self._new_factors, self._new_values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        found = gtsam.utilities.extractPose2(self._smoother.calculateEstimate())
        moved = np.abs(found - np.array(self.poses))
        moved[:, 2] = np.minimum(moved[:, 2], np.abs(2.0 * math.pi - moved[:, 2]))
        self.poses = [Pose2(x, y, yaw) for x, y, yaw in found.tolist()]
        if float(moved.max()) >= _SETTLED:
            return True
        self._steps = 0
        return False

    def spread_from(self, number: int, limit: float) -> NDArray[np.float64]:
        """Compute the uncertainty (m, one standard deviation) of each pose relative to one; inf beyond `limit`.

        The variances of shifts are added up along the path of edges with the least of them. That of a turn is felt by
        the distance from there to the pose: a drive round a block adds less than a straight one of its length.
        """
        if self._table is None:
            count = len(self.poses)
            ends = np.array([(*ends, *ends[::-1]) for ends in self._best], np.int32).reshape(-1, 2)  # both directions
            shifts = np.repeat([max(shift, 1e-12) for shift, _ in self._best.values()], 2)
            self._table = csr_array((shifts, ends.T), shape=(count, count))
        shift, last = dijkstra(self._table, directed=True, indices=number, limit=limit**2, return_predecessors=True)
        known = np.flatnonzero(last >= 0)
        # The turns along each path, and their moments about `number`: with each round twice as many edges are added up
        places = np.array(self.poses)[:, :2] - self.poses[number][:2]
        pairs = np.sort(np.column_stack((last[known], known))).tolist()
        turns = np.array([self._best[before, after][1] for before, after in pairs])
        middles = 0.5 * (places[known] + places[last[known]])
        sums = np.zeros((len(places), 4))
        sums[known] = turns[:, None] * np.column_stack((np.ones(len(known)), middles, np.square(middles).sum(axis=1)))
        last[last < 0] = number
        while (last != number).any():
            sums += sums[last]
            last = last[last]
        swing = sums[:, 3] - 2.0 * (places * sums[:, 1:3]).sum(axis=1) + np.square(places).sum(axis=1) * sums[:, 0]
        spread = np.sqrt(shift + np.maximum(swing, 0.0))
        return np.where(spread <= limit, spread, np.inf)
