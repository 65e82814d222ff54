"""Observations: fiducials that the robot sees at one moment, for mapping and localisation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.rigid import Floats, angle_between
from ur_nodes.vision.detect import PIXEL_NOISE, CandidatePose

# Beside the noise of corners: calibration, size of the print, mounting of the camera, rolling of the base.
_TURN_FLOOR = 0.01  # rad
_SHIFT_FLOOR = 0.005  # m
_SHIFT_SHARE = 0.01  # of the distance
CLEAR = 20.0  # chi squared by which another pose must be worse
_TURN_TOLERANCE = 0.1  # rad by which a known fiducial may seem turned


@dataclass(frozen=True, slots=True)
class Sighting:
    """One possible pose (4, 4) of a fiducial in the robot's frame, with the covariance (6, 6) that Candidate has.

    `cost` is by how much its chi squared is above that of the best one.
    """

    pose: Floats
    covariance: Floats
    cost: float = 0.0


@dataclass(frozen=True, slots=True)
class Observation:
    """A fiducial seen: its possible poses, the better one first."""

    id: int
    sightings: tuple[Sighting, ...]

    @property
    def clear(self) -> bool:
        """True when the first pose is certainly the right one."""
        return bool(self.sightings) and all(each.cost > CLEAR for each in self.sightings[1:])


def choose_sighting(observation: Observation, expected: Floats | None) -> Sighting | None:
    """Choose the pose of a fiducial that is turned as expected in the robot's frame (4, 4).

    Without an expectation it is the first pose, if that is unambiguous. None when no pose is reliable.
    """
    if expected is None:
        return observation.sightings[0] if observation.clear else None
    return min(observation.sightings, key=lambda each: misfit(each, expected), default=None)


def misfit(sighting: Sighting, expected: Floats) -> float:
    """Return the cost of a sighting at a pose (4, 4) of the fiducial in the robot's frame: turn, and own cost."""
    tolerance = _TURN_TOLERANCE**2 + float(np.trace(sighting.covariance[:3, :3]))
    return float(angle_between(sighting.pose, expected) ** 2 / tolerance + sighting.cost)


def make_observation(number: int, base_from_camera: Floats, candidates: Sequence[CandidatePose]) -> Observation:
    """Transform the candidates of a fiducial, at least one, from the camera to the robot.

    Errors that detection cannot estimate are added to the covariances.
    """
    sightings = []
    for each in candidates:
        shift = _SHIFT_FLOOR + _SHIFT_SHARE * float(np.linalg.norm(each.pose[:3, 3]))
        floor = np.diag([_TURN_FLOOR**2] * 3 + [shift**2] * 3)
        cost = 4.0 * (each.error**2 - candidates[0].error ** 2) / PIXEL_NOISE**2  # of four corners
        sightings.append(Sighting(base_from_camera @ each.pose, each.covariance + floor, cost))
    return Observation(number, tuple(sightings))
