"""The pose of a base with its covariance, from the distances that its wheels rolled."""

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

SPEED_COVARIANCE = np.diag((1e-4, 1e-6, 1e-3))
"""Of forward, sideways and turn: encoders measure a speed to about 1 %, and no motion sideways."""
SIDEWAYS_SPEED_COVARIANCE = np.diag((1e-4, 1e-4, 1e-3))
"""Likewise for a base that drives sideways."""


class DeadReckoning:
    """Integrates the rolled distances of two wheels that are `separation` (m) apart, and motion to the left, if any.

    `variance` is that of a rolled distance, m^2 for each m. Sets `pose` (x, y, yaw: m, rad, from where it began) and
    `covariance` of the pose, the upper triangle xx, xy, xw, yy, yw, ww.
    """

    def __init__(self, separation: float, variance: float) -> None:
        self._separation, self._variance = separation, variance
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.covariance = (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6)

    def move(self, dl: float, dr: float, aside: float = 0.0) -> tuple[float, float]:
        """Add distances of the left and right wheel, and to the left, m.

        Returns the distance of the middle ahead (m) and the turn (rad).
        """
        distance, turn = (dl + dr) / 2.0, (dr - dl) / self._separation
        self._spread(dl, dr, distance, turn, aside)
        x, y, yaw = self.pose
        middle = yaw + turn / 2.0
        shorter = math.sin(turn / 2.0) / (turn / 2.0) if abs(turn) > 1e-9 else 1.0
        ahead, left = distance * shorter, aside * shorter
        c, s = math.cos(middle), math.sin(middle)
        yaw = math.remainder(yaw + turn, 2.0 * math.pi)
        self.pose = Pose2(x + ahead * c - left * s, y + ahead * s + left * c, yaw)
        return distance, turn

    def _spread(self, dl: float, dr: float, distance: float, turn: float, aside: float) -> None:
        """Propagate the covariance to first order (Siegwart, Autonomous Mobile Robots, 5.2.4).

        The wheels of a base that drives sideways roll then, too: all three distances are less certain.
        """
        if dl == dr == aside == 0.0:
            return
        angle = self.pose[2] + turn / 2.0
        c, s, b = math.cos(angle), math.sin(angle), self._separation
        fx, fy = -distance * s - aside * c, distance * c - aside * s
        xx, xy, xw, yy, yw, ww = self.covariance
        xx, xy, xw, yy, yw = (
            xx + 2.0 * fx * xw + fx * fx * ww,
            xy + fy * xw + fx * yw + fx * fy * ww,
            xw + fx * ww,
            yy + 2.0 * fy * yw + fy * fy * ww,
            yw + fy * ww,
        )
        for rolled, sign in ((dl, -1.0), (dr, 1.0)):
            q = self._variance * (abs(rolled) + abs(aside))
            h, k = sign * distance / (2.0 * b), sign * aside / (2.0 * b)
            gx, gy, gw = c / 2.0 - h * s - k * c, s / 2.0 + h * c - k * s, sign / b
            xx, xy, xw = xx + q * gx * gx, xy + q * gx * gy, xw + q * gx * gw
            yy, yw, ww = yy + q * gy * gy, yw + q * gy * gw, ww + q * gw * gw
        q = self._variance * abs(aside)
        self.covariance = (xx + q * s * s, xy - q * s * c, xw, yy + q * c * c, yw, ww)


def covariance_matrix(triangle: tuple[float, float, float, float, float, float]) -> NDArray[np.float64]:
    """The matrix (3, 3) of x, y and yaw with an upper triangle, as `DeadReckoning.covariance`."""
    xx, xy, xw, yy, yw, ww = triangle
    return np.array(((xx, xy, xw), (xy, yy, yw), (xw, yw, ww)))
