"""Odometry from wheel encoders, with the errors of real odometry."""

import math

import numpy as np

from ur.robot.base import Base
from ur_nodes.geometry.dead_reckoning import DeadReckoning
from ur_nodes.geometry.pose import Pose2


class EncoderOdometry:
    """Dead reckoning from the two wheel angles, and what the wheels of some bases roll to the left.

    Each wheel's radius and the separation are off by a fixed error drawn once; each distance rolled is off by a random
    error whose variance grows with it; angles are counted in encoder ticks. The model's parameters are Base.odometry.
    All wheels of a base that drives sideways roll when it does: that distance counts for the error of each.
    """

    def __init__(self, base: Base, random: np.random.Generator) -> None:
        model = base.odometry
        radius_errors = random.standard_normal(2) * model.radius_error
        self._tick = 2.0 * math.pi / model.ticks_per_turn
        self._left_scale = self._tick * base.wheels.radius * (1.0 + float(radius_errors[0]))
        self._right_scale = self._tick * base.wheels.radius * (1.0 + float(radius_errors[1]))
        separation = base.wheels.separation * (1.0 + float(random.standard_normal()) * model.separation_error)
        self._sideways = base.limits.sideways  # others draw no random numbers for it
        aside_error = float(random.standard_normal()) * model.radius_error if self._sideways else 0.0
        self._aside_tick = self._tick * base.wheels.radius  # m
        self._aside_scale = self._aside_tick * (1.0 + aside_error)
        self._noise = model.wheel_noise
        # A covariance can express the fixed errors only as if they were drawn again for each metre.
        self._reckoning = DeadReckoning(separation, model.wheel_noise**2 + model.radius_error**2)
        self._random = random
        self._ticks: tuple[int, int, int] | None = None
        self._time = 0.0
        self.velocity = (0.0, 0.0, 0.0)

    @property
    def pose(self) -> Pose2:
        """The pose since the first reading."""
        return self._reckoning.pose

    @property
    def covariance(self) -> tuple[float, float, float, float, float, float]:
        """That of the pose."""
        return self._reckoning.covariance

    def update(self, left: float, right: float, time: float, aside: float = 0.0) -> None:
        """Read the encoders: wheel angles (rad), and the distance to the left (m), at a time (s).

        Sets `pose` and `covariance` (see DeadReckoning), and `velocity`: ahead (m/s), turn (rad/s), to the left (m/s),
        the mean since the last reading.
        """
        turned = (left / self._tick, right / self._tick, aside / self._aside_tick)
        ticks = (math.floor(turned[0]), math.floor(turned[1]), math.floor(turned[2]))
        if self._ticks is None:
            self._ticks, self._time = ticks, time
            return
        da = (ticks[2] - self._ticks[2]) * self._aside_scale
        dl = self._with_noise((ticks[0] - self._ticks[0]) * self._left_scale, da)
        dr = self._with_noise((ticks[1] - self._ticks[1]) * self._right_scale, da)
        da = self._with_noise(da) if self._sideways else 0.0
        distance, turn = self._reckoning.move(dl, dr, da)
        if time > self._time:
            passed = time - self._time
            self.velocity = (distance / passed, turn / passed, da / passed)
        self._ticks, self._time = ticks, time

    def _with_noise(self, distance: float, aside: float = 0.0) -> float:
        """A distance a wheel rolled, with the random error of measuring it. Draws in any case, to keep in step."""
        rolled = abs(distance) + abs(aside)
        return distance + float(self._random.standard_normal()) * self._noise * math.sqrt(rolled)
