"""Angles of the wheels of a base, from the motion of the base."""

from __future__ import annotations

from ur.robot.base import Wheels

LONGEST_GAP = 0.5  # s without odometry, after which it is not known how far the wheels turned


class WheelStates:
    """Angles (rad) and speeds (rad/s) of the left and the right wheel; forward is positive, angles begin at 0."""

    def __init__(self, wheels: Wheels) -> None:
        self._wheels = wheels
        self._time: float | None = None
        self.angles = (0.0, 0.0)
        self.speeds = (0.0, 0.0)

    def update(self, forward: float, turn: float, time: float) -> None:
        """The base moves at m/s and rad/s at a time (s). Differential drive: v +- w b / 2 at the rims."""
        across = turn * self._wheels.separation / 2.0
        speeds = ((forward - across) / self._wheels.radius, (forward + across) / self._wheels.radius)
        gap = time - self._time if self._time is not None else 0.0
        if 0.0 < gap <= LONGEST_GAP:
            left, right = (
                angle + (before + now) / 2.0 * gap
                for angle, before, now in zip(self.angles, self.speeds, speeds, strict=True)
            )
            self.angles = (left, right)
        self.speeds, self._time = speeds, time
