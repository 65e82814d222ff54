"""Velocity ramps that a base can follow, and its controller, from velocity commands to wheel speeds."""

import math
from dataclasses import dataclass

from ur.robot.base import Base, MotionLimits


class WheelDrive:
    """Turns commands into wheel speeds. One call of `update` per control period of the robot.

    The wheel speeds are those of two wheels; `aside` is the setpoint to the left (m/s) of a base that drives sideways.
    """

    def __init__(self, base: Base, period: float) -> None:
        self._age = base.limits.command_age
        self._forward, self._turn = axes_of(base.limits)
        self._left = lateral_axis(base.limits)
        self._radius = base.wheels.radius
        self._half_separation = base.wheels.separation / 2.0
        self._period = period
        self._target = (0.0, 0.0, 0.0)
        self._received = -math.inf
        self._velocity = (0.0, 0.0)
        self.aside = 0.0

    @property
    def velocity(self) -> tuple[float, float]:
        """The velocity setpoint now: m/s, rad/s."""
        return self._velocity

    def command(self, linear: float, angular: float, time: float, left: float = 0.0) -> None:
        """Set a command (m/s ahead and to the left, rad/s) at a time (s), followed within the limits.

        Values that are not finite stop the base.
        """
        if not (math.isfinite(linear) and math.isfinite(angular) and math.isfinite(left)):
            linear = angular = left = 0.0
        self._target = (linear, angular, left)
        self._received = time

    def halt(self) -> None:
        """Set the wheels to rest: the next command accelerates from rest."""
        self._target = (0.0, 0.0, 0.0)
        self._velocity, self.aside = (0.0, 0.0), 0.0

    def update(self, time: float) -> tuple[float, float]:
        """Return the speeds of the left and right wheel (rad/s) for the control period that starts at `time` (s)."""
        fresh = time - self._received <= self._age
        linear, angular, left = self._target if fresh else (0.0, 0.0, 0.0)
        v = approach(self._velocity[0], linear, self._forward, self._period)
        w = approach(self._velocity[1], angular, self._turn, self._period)
        self._velocity = (v, w)
        self.aside = approach(self.aside, left, self._left, self._period)
        turn = w * self._half_separation
        return (v - turn) / self._radius, (v + turn) / self._radius


@dataclass(frozen=True, slots=True)
class Axis:
    """Limits of one direction of motion, each positive: `speed` (m/s or rad/s), and how fast it may grow and shrink.

    `speed_up` holds while the magnitude grows, `slow_down` while it shrinks (m/s^2 or rad/s^2).
    """

    speed: float
    speed_up: float
    slow_down: float

    def clip(self, value: float) -> float:
        """Return the value nearest to `value` within the speed limit; 0 if it is not finite."""
        return max(-self.speed, min(self.speed, value)) if math.isfinite(value) else 0.0


NO_AXIS = Axis(0.0, 1.0, 1.0)
"""The limits of a direction in which a base does not move."""


def axes_of(limits: MotionLimits) -> tuple[Axis, Axis]:
    """Forward and turning limits of a base."""
    return (
        Axis(limits.velocity, limits.acceleration, limits.deceleration),
        Axis(limits.angular_velocity, limits.angular_acceleration, limits.angular_deceleration),
    )


def lateral_axis(limits: MotionLimits) -> Axis:
    """Limits to the left of a base."""
    if not limits.sideways:
        return NO_AXIS
    return Axis(limits.lateral_velocity, limits.acceleration, limits.deceleration)


def approach(value: float, target: float, axis: Axis, seconds: float) -> float:
    """Return the velocity after `seconds` of the fastest permitted change from `value` to `target` (clipped).

    A change of sign brakes to zero first and accelerates in the remaining time.
    """
    if value == target and -axis.speed <= value <= axis.speed:
        return value
    target = axis.clip(target)
    if value * target < 0.0 or abs(target) < abs(value):
        rest = target if value * target > 0.0 else 0.0
        needed = abs(value - rest) / axis.slow_down
        if needed > seconds:
            return value - math.copysign(axis.slow_down * seconds, value)
        value, seconds = rest, seconds - needed
    step = axis.speed_up * seconds
    return target if abs(target - value) <= step else value + math.copysign(step, target - value)
