"""The expected motion between two scans: by odometry, by a measured heading, or as the previous one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.surface import Floats
from ur_nodes.slam.odometry_model import OdometryModel, is_still, with_measured_turn

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
