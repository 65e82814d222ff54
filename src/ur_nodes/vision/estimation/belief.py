"""Joint estimate of a robot's pose and of the systematic errors of its odometry."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import Floats
from ur_nodes.vision.estimation.graph import odometry_sigmas

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
