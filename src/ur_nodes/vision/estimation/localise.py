"""Localisation on a fixed map of fiducials."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import gtsam
import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import Floats, from_planar, invert, to_planar
from ur_nodes.vision.estimation.graph import (
    GATE,
    disagreement,
    fiducial_key,
    find_robot,
    known_factor,
    odometry_sigmas,
    planar_factor,
    robot_key,
    sighting_factor,
)
from ur_nodes.vision.estimation.observation import Observation, Sighting, choose_sighting
from ur_nodes.vision.fiducial_map import MapEntry

_VAGUE = np.diag(np.square([0.5, 0.5, 0.5]))  # m, m, rad: of a first guess
_ERRORS = np.diag(np.square([0.02, 0.02, 0.02]))  # of a wheel base that has not been calibrated


@dataclass(frozen=True, slots=True)
class Errors:
    """Systematic errors of the odometry, to be added: m per m, rad per m, rad per rad (3,).

    `covariance` (3, 3); `together` (3, 3) is the covariance of the place (rows) with them.
    """

    values: Floats
    covariance: Floats
    together: Floats


UNKNOWN_ERRORS = Errors(np.zeros(3), _ERRORS, np.zeros((3, 3)))


@dataclass(frozen=True, slots=True)
class Belief:
    """A planar pose and its covariance (3, 3): of x and y in the robot's frame, and of the heading."""

    pose: Pose2
    covariance: Floats
    errors: Errors

    @property
    def spread(self) -> float:
        """Return the standard deviation of the position, m."""
        return math.sqrt(float(self.covariance[0, 0] + self.covariance[1, 1]))

    def predict(self, measured: Pose2) -> Belief:
        """Return the belief after a motion that odometry has `measured`."""
        distance = math.hypot(measured.x, measured.y)
        if distance < 1e-4 and abs(measured.yaw) < 1e-4:
            return replace(self, pose=self.pose.compose(measured))
        per_m, turn_per_m, turn_per_rad = self.errors.values
        motion = Pose2(
            float(measured.x * (1.0 + per_m)),
            measured.y,
            float(measured.yaw * (1.0 + turn_per_rad) + turn_per_m * measured.x),
        )
        c, s = math.cos(motion.yaw), math.sin(motion.yaw)
        # The adjoint of the inverse motion: errors before it, as seen after it.
        carry = np.array([[c, s, s * motion.x - c * motion.y], [-s, c, c * motion.x + s * motion.y], [0, 0, 1.0]])
        effect = np.array([[measured.x, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, measured.x, measured.yaw]])
        shift, turn = odometry_sigmas(motion)
        together, errors = carry @ self.errors.together, self.errors.covariance
        mixed = together @ effect.T
        covariance = carry @ self.covariance @ carry.T + mixed + mixed.T + effect @ errors @ effect.T
        return Belief(
            self.pose.compose(motion),
            covariance + np.diag(np.square([shift, shift, turn])),
            replace(self.errors, together=together + effect @ errors),
        )

    def correct(self, pose: Pose2, covariance: Floats) -> Belief:
        """Return the belief after another source has set the pose; the estimate of odometry's errors is updated.

        Linear regression of the errors on the place, as a Kalman filter has it.
        """
        gain = np.linalg.solve(self.covariance, self.errors.together).T
        off = self.pose.inverse().compose(pose)
        errors = Errors(
            self.errors.values + gain @ np.array([off.x, off.y, off.yaw]),
            self.errors.covariance - gain @ (self.covariance - covariance) @ gain.T,
            covariance @ gain.T,
        )
        return Belief(pose, covariance, errors)


def guess(pose: Pose2, errors: Errors) -> Belief:
    """Set the robot's pose, to half a metre and half a radian; the estimated errors of its wheels stay."""
    return Belief(pose, _VAGUE, replace(errors, together=np.zeros((3, 3))))


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
        self, known: Iterable[MapEntry], *, start: Pose2 | None = None, spread_limit: float = math.inf
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
