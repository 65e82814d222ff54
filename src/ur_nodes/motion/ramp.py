"""Velocity ramps that a base can follow: braking may be harder than acceleration."""

import math
from dataclasses import dataclass

from ur.robot.base import MotionLimits


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
