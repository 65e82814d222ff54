"""Odometry from wheel encoders, with the errors of real odometry."""

from __future__ import annotations

import math

import numpy as np

from ur.robot.base import Base
from ur_nodes.geometry.pose import Pose2


class EncoderOdometry:
    """Dead reckoning from the two wheel angles.

    Each wheel's radius and the separation are off by a fixed error drawn once; each distance rolled is off by a random
    error whose variance grows with it; angles are counted in encoder ticks. The model's parameters are Base.odometry.
    """

    def __init__(self, base: Base, random: np.random.Generator) -> None:
        model = base.odometry
        radius_errors = random.standard_normal(2) * model.radius_error
        self._tick = 2.0 * math.pi / model.ticks_per_turn
        self._left_scale = self._tick * base.wheels.radius * (1.0 + float(radius_errors[0]))
        self._right_scale = self._tick * base.wheels.radius * (1.0 + float(radius_errors[1]))
        self._separation = base.wheels.separation * (1.0 + float(random.standard_normal()) * model.separation_error)
        self._noise = model.wheel_noise
        # What a covariance can express of the fixed errors: as if they were drawn anew for each metre.
        self._variance = model.wheel_noise**2 + model.radius_error**2
        self._random = random
        self._ticks: tuple[int, int] | None = None
        self._time = 0.0
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.velocity = (0.0, 0.0)
        self.covariance = (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6)

    def update(self, left: float, right: float, time: float) -> None:
        """Read the encoders: wheel angles (rad) at a time (s).

        Sets `pose` (x, y, yaw: m, rad, from where the first reading was), `velocity` (m/s, rad/s, the mean since the
        last reading), and `covariance` of the pose, the upper triangle xx, xy, xw, yy, yw, ww.
        """
        ticks = (math.floor(left / self._tick), math.floor(right / self._tick))
        if self._ticks is None:
            self._ticks, self._time = ticks, time
            return
        dl = self._with_noise((ticks[0] - self._ticks[0]) * self._left_scale)
        dr = self._with_noise((ticks[1] - self._ticks[1]) * self._right_scale)
        distance, turn = (dl + dr) / 2.0, (dr - dl) / self._separation
        self._spread(dl, dr, distance, turn)
        x, y, yaw = self.pose
        middle = yaw + turn / 2.0
        chord = distance * (math.sin(turn / 2.0) / (turn / 2.0) if abs(turn) > 1e-9 else 1.0)
        yaw = math.remainder(yaw + turn, 2.0 * math.pi)
        self.pose = Pose2(x + chord * math.cos(middle), y + chord * math.sin(middle), yaw)
        if time > self._time:
            self.velocity = (distance / (time - self._time), turn / (time - self._time))
        self._ticks, self._time = ticks, time

    def _with_noise(self, distance: float) -> float:
        """A distance a wheel rolled, with the random error of measuring it. Draws in any case, to keep in step."""
        return distance + float(self._random.standard_normal()) * self._noise * math.sqrt(abs(distance))

    def _spread(self, dl: float, dr: float, distance: float, turn: float) -> None:
        """Propagate the covariance to first order (Siegwart, Autonomous Mobile Robots, 5.2.4)."""
        if dl == dr == 0.0:
            return
        angle = self.pose[2] + turn / 2.0
        c, s, b = math.cos(angle), math.sin(angle), self._separation
        fx, fy = -distance * s, distance * c
        xx, xy, xw, yy, yw, ww = self.covariance
        xx, xy, xw, yy, yw = (
            xx + 2.0 * fx * xw + fx * fx * ww,
            xy + fy * xw + fx * yw + fx * fy * ww,
            xw + fx * ww,
            yy + 2.0 * fy * yw + fy * fy * ww,
            yw + fy * ww,
        )
        for rolled, sign in ((dl, -1.0), (dr, 1.0)):
            q = self._variance * abs(rolled)
            h = sign * distance / (2.0 * b)
            gx, gy, gw = c / 2.0 - h * s, s / 2.0 + h * c, sign / b
            xx, xy, xw = xx + q * gx * gx, xy + q * gx * gy, xw + q * gx * gw
            yy, yw, ww = yy + q * gy * gy, yw + q * gy * gw, ww + q * gw * gw
        self.covariance = (xx, xy, xw, yy, yw, ww)
