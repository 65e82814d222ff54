"""Factors for mapping and localisation with gtsam. Rotation precedes translation, as in gtsam's Pose3."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping

import gtsam
import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.rigid import Floats, from_planar, invert, make_rigid, to_planar
from ur_nodes.vision.estimation.observation import CLEAR, Observation, Sighting
from ur_nodes.vision.fiducial_map import MapEntry

GATE = 60.0
"""Chi squared (six degrees of freedom) beyond which a sighting contradicts what is believed."""

_SAME_PLACE, _SAME_TURN = 0.4, 0.3  # m, rad within which two guesses are one


def find_robot(known: Mapping[int, MapEntry], observations: Iterable[Observation]) -> Pose2 | None:
    """Find the one pose on the floor that explains all sightings; None when there is none, or several.

    A pose scores for each fiducial that it explains; one moved fiducial is outvoted by two others.
    """
    seen = [each for each in observations if each.id in known]
    guesses = [robot_from(known[each.id].pose, sighting) for each in seen for sighting in each.sightings]
    if not guesses:
        return None
    costs = [sum(_misfit(guess, known[each.id], each) for each in seen) for guess in guesses]
    best = min(range(len(guesses)), key=lambda index: costs[index])
    place = to_planar(guesses[best])
    if costs[best] >= GATE * len(seen):
        return None
    rivals = [cost for guess, cost in zip(guesses, costs, strict=True) if not _is_near(to_planar(guess), place)]
    return place if all(cost - costs[best] > CLEAR for cost in rivals) else None


def disagreement(robot: Floats, entry: MapEntry, sighting: Sighting) -> float:
    """Chi squared (six degrees of freedom) between a sighting and what a robot at a pose (4, 4) would see."""
    off = deviation(robot, entry.pose, sighting)
    return float(off @ np.linalg.solve(sighting.covariance + entry.covariance, off))


def deviation(robot: Floats, fiducial: Floats, sighting: Sighting) -> Floats:
    """From a sighting to what a robot at a pose (4, 4) would see of a fiducial: rotation, translation (6,)."""
    expected = gtsam.Pose3(invert(robot) @ fiducial)
    return np.asarray(gtsam.Pose3.Logmap(gtsam.Pose3(sighting.pose).between(expected)), np.float64)


def without_twins(observations: Iterable[Observation]) -> tuple[tuple[Observation, ...], tuple[int, ...]]:
    """Split the sightings of a picture into those with a unique number, and the numbers that appear twice."""
    seen = tuple(observations)
    counts = Counter(each.id for each in seen)
    twins = tuple(sorted(number for number, count in counts.items() if count > 1))
    return tuple(each for each in seen if each.id not in twins), twins


def _misfit(robot: Floats, entry: MapEntry, observation: Observation) -> float:
    return min(min(GATE, disagreement(robot, entry, each) + each.cost) for each in observation.sightings)


def _is_near(a: Pose2, b: Pose2) -> bool:
    return math.hypot(a.x - b.x, a.y - b.y) < _SAME_PLACE and abs(wrap_angle(a.yaw - b.yaw)) < _SAME_TURN


_FREE = 1e3  # m or rad: no knowledge
_LEVEL = (0.005, 0.005, _FREE, _FREE, _FREE, 0.005)  # how well the floor holds roll, pitch and height
_SHIFT_PER_M, _TURN_PER_RAD, _TURN_PER_M = 0.03, 0.03, 0.02  # of odometry: m per m, rad per rad, rad per m
_LEAST_SHIFT, _LEAST_TURN = 0.003, 0.003  # m, rad: of any motion
_HUBER = 1.345  # standard deviations beyond which an observation counts less; 95 % efficient for normal noise


def odometry_sigmas(motion: Pose2) -> tuple[float, float]:
    """The standard deviations of position (m) and heading (rad) by odometry after a motion."""
    way, turn = math.hypot(motion.x, motion.y), abs(motion.yaw)
    return _LEAST_SHIFT + _SHIFT_PER_M * way, _LEAST_TURN + _TURN_PER_RAD * turn + _TURN_PER_M * way


def robot_key(number: int) -> int:
    """The variable of the robot's pose at a moment."""
    return int(gtsam.symbol("x", number))


def fiducial_key(number: int) -> int:
    """The variable of a fiducial's pose."""
    return int(gtsam.symbol("f", number))


def level_factor(number: int, guess: Floats) -> gtsam.NonlinearFactor:
    """Constrain the robot to the floor: x, y and heading are free."""
    level = gtsam.Pose3(from_planar_of(guess))
    return gtsam.PriorFactorPose3(robot_key(number), level, gtsam.noiseModel.Diagonal.Sigmas(np.array(_LEVEL)))


def start_factor(number: int, pose: Floats, shift: float, turn: float) -> gtsam.NonlinearFactor:
    """Constrain the robot to a pose, with the given deviations (m, rad)."""
    sigmas = np.array([0.005, 0.005, turn, shift, shift, 0.005])
    return gtsam.PriorFactorPose3(robot_key(number), gtsam.Pose3(pose), gtsam.noiseModel.Diagonal.Sigmas(sigmas))


def planar_factor(number: int, pose: Floats, covariance: Floats) -> gtsam.NonlinearFactor:
    """Constrain the robot to a pose, with a covariance (3, 3) of x, y (in the robot's frame) and heading."""
    whole = np.diag(np.square([0.005, 0.005, 0.0, 0.0, 0.0, 0.005]))
    places = [3, 4, 2]
    whole[np.ix_(places, places)] = covariance
    return gtsam.PriorFactorPose3(robot_key(number), gtsam.Pose3(pose), gtsam.noiseModel.Gaussian.Covariance(whole))


def odometry_factor(before: int, after: int, motion: Pose2) -> gtsam.NonlinearFactor:
    """Add a motion of the robot, measured by its wheels."""
    shift, turn = odometry_sigmas(motion)
    sigmas = np.array([0.01, 0.01, turn, shift, shift, 0.01])
    model = gtsam.noiseModel.Diagonal.Sigmas(sigmas)
    return gtsam.BetweenFactorPose3(robot_key(before), robot_key(after), gtsam.Pose3(from_planar(motion)), model)


def sighting_factor(number: int, fiducial: int, sighting: Sighting) -> gtsam.NonlinearFactor:
    """Add a sighting of a fiducial; one that contradicts all others loses its weight."""
    model = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), gtsam.noiseModel.Gaussian.Covariance(sighting.covariance)
    )
    return gtsam.BetweenFactorPose3(robot_key(number), fiducial_key(fiducial), gtsam.Pose3(sighting.pose), model)


def known_factor(fiducial: int, pose: Floats, covariance: Floats) -> gtsam.NonlinearFactor:
    """Constrain a fiducial to a known pose."""
    return gtsam.PriorFactorPose3(
        fiducial_key(fiducial), gtsam.Pose3(pose), gtsam.noiseModel.Gaussian.Covariance(covariance)
    )


def from_planar_of(pose: Floats) -> Floats:
    """Return the level pose with the x, y and heading of a pose."""
    heading = math.atan2(pose[1, 0], pose[0, 0])
    c, s = math.cos(heading), math.sin(heading)
    return make_rigid(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([*pose[:2, 3], 0.0]))


def robot_from(fiducial: Floats, sighting: Sighting) -> Floats:
    """Return the level pose of a robot from its view of a known fiducial."""
    return from_planar_of(fiducial @ invert(sighting.pose))
