"""Changes of velocity that a base can follow: it may stop harder than it starts."""

from __future__ import annotations

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
        """The value nearest to `value` within the speed limit; 0 for what is not finite."""
        return max(-self.speed, min(self.speed, value)) if math.isfinite(value) else 0.0


def axes_of(limits: MotionLimits) -> tuple[Axis, Axis]:
    """Forward and turning limits of a base."""
    return (
        Axis(limits.velocity, limits.acceleration, limits.deceleration),
        Axis(limits.angular_velocity, limits.angular_acceleration, limits.angular_deceleration),
    )


def approach(value: float, target: float, axis: Axis, seconds: float) -> float:
    """The velocity after `seconds` of the fastest change from `value` to `target` (clipped) that the limits allow.

    A change of sign brakes to zero first and uses what is left of the time to speed up.
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
