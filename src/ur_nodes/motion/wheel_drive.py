"""The controller of a base, from velocity commands to wheel speeds: limits, ramps, and a stop when commands are old."""

import math

from ur.robot.base import Base
from ur_nodes.motion.ramp import approach, axes_of, lateral_axis


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
