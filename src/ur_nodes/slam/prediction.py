"""The expected motion between two scans, and the errors of the odometry that it is computed from."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.calibration import with_turn
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.surface import Floats

_START = np.diag(np.square((0.05, 0.05, 0.05)))  # of scale, of turns per turn, of rad per m
_MEMORY = 0.995  # how much of what was learned remains with each motion
_NOISE = (0.02, 0.02)  # m per root m, rad per root m: what is random in a motion that teaches
_STILL = (0.002, 0.002)  # m, rad: odometry that reports less motion means that the robot is at rest
_GYRO_NOISE = (0.004, 0.02)  # rad, rad per rad: of a heading between two scans
_TEACHES = (0.05, 0.2)  # m, rad: smaller motions teach nothing
_SHORTEST = 0.1  # m: the noise of shorter motions is that of one so long
_MOST_SURPRISE = 4.0  # standard deviations: more means that the wheels slipped, or that the scan was matched wrongly
_SHIFT_NOISE = (0.005, 0.05, 0.02)  # m, m per m driven, m per rad turned
_TURN_NOISE = (0.004, 0.03, 0.08)  # rad, rad per m driven, rad per rad turned


class OdometryModel:
    """Corrects motions by learned errors: a factor for lengths, a factor for turns, and a turn per metre."""

    def __init__(self) -> None:
        self._errors = np.zeros(3)  # of scale, of turns per turn, rad per m
        self._covariance = _START.copy()

    def correct(self, motion: Pose2) -> Pose2:
        """Return the most likely motion for one that odometry reports."""
        scale, turn, drift = self._errors
        distance = math.hypot(motion.x, motion.y)
        factor = 1.0 + scale
        longer = Pose2(factor * motion.x, factor * motion.y, motion.yaw)
        return with_turn(longer, motion.yaw * (1.0 + turn) + drift * distance)

    def covariance(self, motion: Pose2) -> Floats:
        """Return the covariance (3, 3) of a corrected motion in its frame: random errors, and those not yet learned."""
        distance, angle = math.hypot(motion.x, motion.y), abs(motion.yaw)
        scale, turn, drift = np.sqrt(np.diag(self._covariance))
        least, per_metre, per_radian = _SHIFT_NOISE
        shift = least + (per_metre + scale) * distance + per_radian * angle
        least, per_metre, per_radian = _TURN_NOISE
        swing = least + (per_metre + drift) * distance + (per_radian + turn) * angle
        return np.diag(np.square((shift, shift, swing)))

    def learn(self, reported: Pose2, true: Pose2) -> None:
        """Compare a motion that odometry reported with the true one: a Kalman filter of the three systematic errors."""
        distance, real = math.hypot(reported.x, reported.y), math.hypot(true.x, true.y)
        if distance < _TEACHES[0] and abs(reported.yaw) < _TEACHES[1]:
            return
        rows = np.array(((distance, 0.0, 0.0), (0.0, reported.yaw, distance)))
        seen = np.array((real - distance, math.remainder(true.yaw - reported.yaw, 2.0 * math.pi)))
        noise = np.diag(np.square(_NOISE)) * max(distance, _SHORTEST)
        before = self._covariance / _MEMORY
        innovation = rows @ before @ rows.T + noise
        surprise = seen - rows @ self._errors
        if surprise @ np.linalg.solve(innovation, surprise) > _MOST_SURPRISE**2:
            return
        gain = before @ rows.T @ np.linalg.inv(innovation)
        self._errors = self._errors + gain @ surprise
        self._covariance = (np.eye(3) - gain @ rows) @ before


def is_still(reported: Pose2) -> bool:
    """Return whether a reported motion means that the robot is at rest."""
    return math.hypot(reported.x, reported.y) < _STILL[0] and abs(reported.yaw) < _STILL[1]


def with_measured_turn(motion: Pose2, covariance: Floats, turn: float) -> tuple[Pose2, Floats]:
    """Return a motion and its covariance (3, 3) with a turn (rad) that was measured independently of the wheels."""
    exact = covariance.copy()
    exact[2] = exact[:, 2] = 0.0
    exact[2, 2] = min(covariance[2, 2], (_GYRO_NOISE[0] + _GYRO_NOISE[1] * abs(turn)) ** 2)
    return with_turn(motion, turn), exact


UNKNOWN_MOTION = np.diag(np.square((0.1, 0.1, 0.15)))
"""The covariance (m, rad) of a motion between two scans that nothing is known of."""


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """A `motion`, its `covariance` (3, 3) in the frame before it, and `still`: the robot is at rest.

    `wheels` is the motion by odometry alone, corrected for systematic errors.
    """

    motion: Pose2
    wheels: Pose2
    covariance: Floats
    still: bool


class MotionPredictor:
    """Predicts the motion from the last scan to the next one; learns the errors of odometry."""

    def __init__(self) -> None:
        self._model = OdometryModel()
        self._motion = Pose2(0.0, 0.0, 0.0)  # between the last two scans
        self._odometry: Pose2 | None = None  # at the last scan
        self._heading: float | None = None  # rad, likewise

    def predict(self, odometry: Pose2 | None, heading: float | None) -> Prediction:
        """Predict the motion to a scan with this pose of odometry, and this heading (rad, from an arbitrary origin)."""
        wheels, covariance, still = self._motion, UNKNOWN_MOTION, False
        if odometry is not None and self._odometry is not None:
            reported = self._odometry.inverse().compose(odometry)
            wheels, covariance = self._model.correct(reported), self._model.covariance(reported)
            still = is_still(reported)
        motion = wheels
        if heading is not None and self._heading is not None and self._odometry is not None:
            motion, covariance = with_measured_turn(wheels, covariance, heading - self._heading)
        return Prediction(motion, wheels, covariance, still)

    def add(self, odometry: Pose2 | None, heading: float | None, motion: Pose2 | None = None) -> None:
        """Add a scan's odometry and heading, and the `motion` to it by the map; None for the first scan."""
        self._odometry, self._heading = odometry, heading
        self._motion = self._motion if motion is None else motion

    def learn(self, reported: Pose2, true: Pose2) -> None:
        """Compare a motion that odometry reported with the true one."""
        self._model.learn(reported, true)

    def go_on_from(self, other: MotionPredictor) -> None:
        """Take over the last scan of another predictor, but not its learned errors."""
        self._motion, self._odometry, self._heading = other._motion, other._odometry, other._heading
