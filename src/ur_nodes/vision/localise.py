"""Where the robot is on a map of fiducials that stays as it is."""

from __future__ import annotations

import math
from collections.abc import Iterable

import gtsam
import numpy as np

from ur_nodes.rosio.pose import Pose2
from ur_nodes.vision.fiducial_map import MapEntry
from ur_nodes.vision.graph import (
    DEFAULT_NOISE,
    OdometryNoise,
    fiducial_key,
    known_factor,
    planar_factor,
    robot_from,
    robot_key,
    sighting_factor,
)
from ur_nodes.vision.observation import Observation, Sighting, choose_sighting
from ur_nodes.vision.rigid import Floats, from_planar, invert, to_planar

_LOST = (0.5, 0.5, 0.5)  # standard deviations (m, m, rad) of a first guess from one fiducial
_GATE = 60.0  # chi squared beyond which a sighting contradicts what is believed
_CONTRADICTIONS = 5  # pictures in a row: then the robot was moved by hand, and is found anew


class Localiser:
    """A planar pose with its covariance: odometry moves it, pictures correct it (a small factor graph for each)."""

    def __init__(
        self, known: Iterable[MapEntry], *, start: Pose2 | None = None, noise: OdometryNoise = DEFAULT_NOISE
    ) -> None:
        """`start` is where the robot is believed to be; None: it is found out from the first known fiducial."""
        self._known = {entry.id: entry for entry in known}
        self._noise = noise
        self._odometry: Pose2 | None = None
        self._contradictions = 0
        self._pose: Pose2 | None = None
        self.covariance: Floats = np.diag(np.square(_LOST))
        if start is not None:
            self.place(start)

    def place(self, pose: Pose2) -> None:
        """The robot is said to be somewhere, to half a metre and half a radian."""
        self._pose = pose
        self._odometry = None
        self._contradictions = 0
        self.covariance = np.diag(np.square(_LOST))

    def robot(self, odometry: Pose2) -> Pose2 | None:
        """Where the robot is in the map, given what odometry says now; None while it is not known."""
        if self._pose is None or self._odometry is None:
            return self._pose
        return self._pose.compose(self._odometry.inverse().compose(odometry))

    def add(self, odometry: Pose2, observations: Iterable[Observation]) -> bool:
        """Take in what is seen at a moment. Returns whether a known fiducial was of use."""
        self._predict(odometry)
        seen = tuple(each for each in observations if each.id in self._known)
        if self._pose is None:
            clear = next((each for each in seen if each.clear), None)
            if clear is None:
                return False
            self._pose = to_planar(robot_from(self._known[clear.id].pose, clear.sightings[0]))
        return bool(seen) and self._correct(seen)

    def _predict(self, odometry: Pose2) -> None:
        if self._odometry is not None and self._pose is not None:
            motion = self._odometry.inverse().compose(odometry)
            shift, turn = self._noise.sigmas(motion)
            way = math.hypot(motion.x, motion.y)
            if way > 1e-4 or abs(motion.yaw) > 1e-4:
                c, s = math.cos(motion.yaw), math.sin(motion.yaw)
                # The adjoint of the inverse motion: errors before it, as seen after it.
                carry = np.array(
                    [[c, s, s * motion.x - c * motion.y], [-s, c, c * motion.x + s * motion.y], [0, 0, 1.0]]
                )
                self.covariance = carry @ self.covariance @ carry.T + np.diag(np.square([shift, shift, turn]))
            self._pose = self._pose.compose(motion)
        self._odometry = odometry

    def _correct(self, seen: tuple[Observation, ...]) -> bool:
        assert self._pose is not None
        guess = from_planar(self._pose)
        chosen = [
            (self._known[each.id], choose_sighting(each, invert(guess) @ self._known[each.id].pose)) for each in seen
        ]
        used = [(entry, sighting) for entry, sighting in chosen if sighting]
        if not used:
            return False
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        values.insert(robot_key(0), gtsam.Pose3(guess))
        graph.push_back(planar_factor(0, guess, self.covariance))
        for entry, sighting in used:
            graph.push_back(known_factor(entry.id, entry.pose, entry.covariance))
            values.insert(fiducial_key(entry.id), gtsam.Pose3(entry.pose))
            graph.push_back(sighting_factor(0, entry.id, sighting))
        solved = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
        better = np.asarray(solved.atPose3(robot_key(0)).matrix())
        contradicting = sum(disagreement(better, entry, sighting) > _GATE for entry, sighting in used)
        if 2 * contradicting > len(used):
            self._doubt()
            return False
        self._contradictions = 0
        places = [3, 4, 2]
        marginal = np.asarray(gtsam.Marginals(graph, solved).marginalCovariance(robot_key(0)))
        self._pose, self.covariance = to_planar(better), marginal[np.ix_(places, places)]
        return True

    def _doubt(self) -> None:
        """The picture is not believed; after several in a row the belief goes instead."""
        self._contradictions += 1
        if self._contradictions >= _CONTRADICTIONS:
            self._contradictions = 0
            self._pose = None
            self.covariance = np.diag(np.square(_LOST))


def disagreement(robot: Floats, entry: MapEntry, sighting: Sighting) -> float:
    """Chi squared (six degrees of freedom) between a sighting and what a robot at a pose (4, 4) would see."""
    expected = gtsam.Pose3(invert(robot) @ entry.pose)
    off = gtsam.Pose3.Logmap(gtsam.Pose3(sighting.pose).between(expected))
    return float(off @ np.linalg.solve(sighting.covariance + entry.covariance, off))
