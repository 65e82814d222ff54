"""Localisation on a fixed map of fiducials."""

import math
from collections.abc import Iterable, Sequence

import gtsam
import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import Floats, from_planar, invert, to_planar
from ur_nodes.vision.estimation.belief import UNKNOWN_ERRORS, Belief, Errors, guess
from ur_nodes.vision.estimation.graph import (
    fiducial_key,
    known_factor,
    planar_factor,
    robot_key,
    sighting_factor,
)
from ur_nodes.vision.estimation.observation import Observation, Sighting, choose_sighting
from ur_nodes.vision.estimation.search import GATE, disagreement, find_robot
from ur_nodes.vision.fiducial_map import MapEntry

_CONTRADICTIONS = 5  # pictures in a row in which several fiducials contradict: then the robot was moved by hand
_LONE_CONTRADICTIONS = 30  # the same with one fiducial only: that may have been moved itself
_PLACES = [3, 4, 2]  # x, y, heading among rotation and translation

_Used = tuple[MapEntry, Sighting]


class FiducialLocaliser:
    """A planar pose with its covariance: odometry moves it, pictures correct it (a small factor graph for each).

    The errors of the odometry are estimated meanwhile.

    A fiducial that contradicts the others, or alone contradicts the estimate, is ignored. Where what is seen
    contradicts for long, or odometry has been alone for too long, the robot is lost: it has no place until what it
    sees tells one again.
    """

    def __init__(
        self,
        known: Iterable[MapEntry],
        *,
        start: Pose2 | None = None,
        spread_limit: float = math.inf,
    ) -> None:
        """`start` is the robot's initial pose; None: it is found from the first sightings.

        `spread_limit` (m) is the standard deviation of the place beyond which the robot is lost.
        """
        self._known = {entry.id: entry for entry in known}
        self._limit = spread_limit
        self._odometry: Pose2 | None = None
        self._contradictions = 0
        self._contradicting: set[int] = set()
        self._errors = UNKNOWN_ERRORS
        self._belief: Belief | None = None
        if start is not None:
            self.set_pose(start)

    @property
    def contradicting(self) -> frozenset[int]:
        """Return the fiducials whose last sighting contradicted the map."""
        return frozenset(self._contradicting)

    @property
    def spread(self) -> float:
        """Return the standard deviation of the position, m; infinite while it is unknown."""
        return self._belief.spread if self._belief else math.inf

    @property
    def covariance(self) -> Floats:
        """Return the covariance (3, 3) of x and y in the robot's frame and of its heading, while the pose is known."""
        return self._belief.covariance if self._belief else np.full((3, 3), math.inf)

    @property
    def errors(self) -> Errors:
        """The estimated errors of the wheels."""
        return self._belief.errors if self._belief else self._errors

    def set_pose(self, pose: Pose2) -> None:
        """Set the robot's pose, to half a metre and half a radian."""
        self.forget()
        self._belief = guess(pose, self._errors)

    def forget(self) -> None:
        """Forget the robot's pose: the next sightings determine it."""
        self._errors = self.errors
        self._belief = self._odometry = None
        self._contradictions = 0
        self._contradicting.clear()

    def robot(self, odometry: Pose2) -> Pose2 | None:
        """Return the robot's pose in the map for the present odometry; None while it is not known."""
        if self._belief is None or self._odometry is None:
            return self._belief.pose if self._belief else None
        return self._belief.pose.compose(self._odometry.inverse().compose(odometry))

    def add(self, odometry: Pose2, observations: Iterable[Observation]) -> bool:
        """Add the observations of a moment. Returns whether a known fiducial was used."""
        if self._odometry is not None and self._belief is not None:
            self._belief = self._belief.predict(self._odometry.inverse().compose(odometry))
        self._odometry = odometry
        seen = tuple(each for each in observations if each.id in self._known and each.sightings)
        if self._belief is None:
            place = find_robot(self._known, seen)
            if place is None:
                return False
            self._belief = guess(place, self._errors)
        if seen and self._correct(self._belief, seen):
            return True
        if self._belief is not None and self.spread > self._limit:
            self.forget()
        return False

    def _correct(self, belief: Belief, seen: tuple[Observation, ...]) -> bool:
        here = from_planar(belief.pose)
        chosen = [
            (self._known[each.id], choose_sighting(each, invert(here) @ self._known[each.id].pose)) for each in seen
        ]
        used = [(entry, sighting) for entry, sighting in chosen if sighting]
        if not used:
            return False
        better, covariance = _solve(belief, used)
        wrong = {entry.id for entry, sighting in used if disagreement(better, entry, sighting) > GATE}
        self._contradicting -= {entry.id for entry, _ in used}
        self._contradicting |= wrong
        if 2 * len(wrong) > len(used):
            # Reject the picture; after several in a row, reject the estimate instead
            self._contradictions += 1
            several = len(self._contradicting) > 1
            if self._contradictions >= (_CONTRADICTIONS if several else _LONE_CONTRADICTIONS):
                odometry = self._odometry
                self.forget()
                self._odometry = odometry
            return False
        if wrong:
            better, covariance = _solve(belief, [each for each in used if each[0].id not in wrong])
        self._contradictions = 0
        self._belief = belief.correct(to_planar(better), covariance)
        return True


def _solve(belief: Belief, used: Sequence[_Used]) -> tuple[Floats, Floats]:
    """Find the pose (4, 4) that agrees best with belief and sightings, and its planar covariance (3, 3)."""
    here = from_planar(belief.pose)
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    values.insert(robot_key(0), gtsam.Pose3(here))
    graph.push_back(planar_factor(0, here, belief.covariance))
    for entry, sighting in used:
        graph.push_back(known_factor(entry.id, entry.pose, entry.covariance))
        values.insert(fiducial_key(entry.id), gtsam.Pose3(entry.pose))
        graph.push_back(sighting_factor(0, entry.id, sighting))
    solved = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    marginal = np.asarray(gtsam.Marginals(graph, solved).marginalCovariance(robot_key(0)))
    return np.asarray(solved.atPose3(robot_key(0)).matrix()), marginal[np.ix_(_PLACES, _PLACES)]
