"""The odometry of a base from the counters of its wheels. Pure."""

import math
from dataclasses import dataclass

from ur.robot.base import Base
from ur_nodes.drivers.readings import Counts
from ur_nodes.geometry.dead_reckoning import DeadReckoning

SLACK = 0.1  # s: readings arrive late, and two at once
_BEYOND = 2.0  # times the fastest speed of a rim


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion between two readings: m/s and rad/s of the base, rad/s of the wheels."""

    forward: float
    turn: float
    wheel_speeds: tuple[float, float]


class CounterOdometry:
    """Sums up readings of the counters; `angles` are those of the wheels since the first one, rad."""

    def __init__(self, base: Base, counts_per_turn: float) -> None:
        errors, limits = base.odometry, base.limits
        self._radius = base.wheels.radius
        self._turn = 2.0 * math.pi / counts_per_turn
        rim = limits.velocity + limits.angular_velocity * base.wheels.separation / 2.0
        self._fastest = _BEYOND * rim / self._radius  # rad/s
        self._last: tuple[Counts, float] | None = None
        self.reckoning = DeadReckoning(base.wheels.separation, errors.wheel_noise**2 + errors.radius_error**2)
        self.angles = (0.0, 0.0)

    @property
    def begun(self) -> bool:
        """There was a reading since the beginning, or since the device was away."""
        return self._last is not None

    def forget(self) -> None:
        """The device was away: its next reading is a new beginning, and the pose stays."""
        self._last = None

    def update(self, counts: Counts, time: float) -> Motion | None:
        """Take a reading at a time (s).

        Returns None, and moves nothing, for the first one and for one that no wheel can have turned: a counter that was
        set back, or a damaged reading. The next one counts from it.
        """
        last, self._last = self._last, (counts, time)
        if last is None:
            return None
        passed = time - last[1]
        left = _difference(counts.left, last[0].left, counts.bits) * self._turn
        right = _difference(counts.right, last[0].right, counts.bits) * self._turn
        if max(abs(left), abs(right)) > self._fastest * (max(passed, 0.0) + SLACK):
            return None
        self.angles = (self.angles[0] + left, self.angles[1] + right)
        distance, turn = self.reckoning.move(left * self._radius, right * self._radius)
        if passed <= 0.0:
            return Motion(0.0, 0.0, (0.0, 0.0))
        return Motion(distance / passed, turn / passed, (left / passed, right / passed))


def _difference(now: int, before: int, bits: int) -> int:
    """The shortest way from one reading of a counter that wraps to the next."""
    half = 1 << (bits - 1)
    return (now - before + half) % (2 * half) - half
