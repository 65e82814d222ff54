"""What a base's controller does with velocity commands: limits, ramps, and a stop when they become old."""

from __future__ import annotations

import math

from ur.robot.base import Base


class Drive:
    """Turns commands into wheel speeds. One call of `update` per control period of the robot."""

    def __init__(self, base: Base, period: float) -> None:
        self._limits = base.limits
        self._radius = base.wheels.radius
        self._half_separation = base.wheels.separation / 2.0
        self._period = period
        self._target = (0.0, 0.0)
        self._received = -math.inf
        self._velocity = (0.0, 0.0)

    @property
    def velocity(self) -> tuple[float, float]:
        """The velocity that is asked of the wheels now: m/s, rad/s."""
        return self._velocity

    def command(self, linear: float, angular: float, time: float) -> None:
        """A command (m/s, rad/s) at a time (s), clipped to the limits. One that is not finite means stop."""
        limits = self._limits
        if not (math.isfinite(linear) and math.isfinite(angular)):
            linear = angular = 0.0
        self._target = (
            max(-limits.velocity, min(limits.velocity, linear)),
            max(-limits.angular_velocity, min(limits.angular_velocity, angular)),
        )
        self._received = time

    def update(self, time: float) -> tuple[float, float]:
        """Speeds of the left and right wheel (rad/s) for the control period that starts at `time` (s)."""
        limits = self._limits
        fresh = time - self._received <= limits.command_age
        linear, angular = self._target if fresh else (0.0, 0.0)
        v = _approach(self._velocity[0], linear, limits.acceleration * self._period)
        w = _approach(self._velocity[1], angular, limits.angular_acceleration * self._period)
        self._velocity = (v, w)
        turn = w * self._half_separation
        return (v - turn) / self._radius, (v + turn) / self._radius


def _approach(value: float, target: float, step: float) -> float:
    return target if abs(target - value) <= step else value + math.copysign(step, target - value)
