"""Search for a robot's pose from sightings of a known map alone, and for sightings that contradict others."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping

import gtsam
import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.rigid import Floats, invert, to_planar
from ur_nodes.vision.estimation.graph import robot_from
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
