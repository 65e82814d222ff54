"""Odometry from wheel encoders, with the errors of real odometry."""

from __future__ import annotations

import math

import numpy as np

from ur.robot.base import Base
from ur_nodes.geometry.dead_reckoning import DeadReckoning
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
        separation = base.wheels.separation * (1.0 + float(random.standard_normal()) * model.separation_error)
        self._noise = model.wheel_noise
        # A covariance can express the fixed errors only as if they were drawn again for each metre.
        self._reckoning = DeadReckoning(separation, model.wheel_noise**2 + model.radius_error**2)
        self._random = random
        self._ticks: tuple[int, int] | None = None
        self._time = 0.0
        self.velocity = (0.0, 0.0)

    @property
    def pose(self) -> Pose2:
        """The pose since the first reading."""
        return self._reckoning.pose

    @property
    def covariance(self) -> tuple[float, float, float, float, float, float]:
        """That of the pose."""
        return self._reckoning.covariance

    def update(self, left: float, right: float, time: float) -> None:
        """Read the encoders: wheel angles (rad) at a time (s).

        Sets `pose` and `covariance` (see DeadReckoning), and `velocity`: m/s, rad/s, the mean since the last reading.
        """
        ticks = (math.floor(left / self._tick), math.floor(right / self._tick))
        if self._ticks is None:
            self._ticks, self._time = ticks, time
            return
        dl = self._with_noise((ticks[0] - self._ticks[0]) * self._left_scale)
        dr = self._with_noise((ticks[1] - self._ticks[1]) * self._right_scale)
        distance, turn = self._reckoning.move(dl, dr)
        if time > self._time:
            self.velocity = (distance / (time - self._time), turn / (time - self._time))
        self._ticks, self._time = ticks, time

    def _with_noise(self, distance: float) -> float:
        """A distance a wheel rolled, with the random error of measuring it. Draws in any case, to keep in step."""
        return distance + float(self._random.standard_normal()) * self._noise * math.sqrt(abs(distance))
