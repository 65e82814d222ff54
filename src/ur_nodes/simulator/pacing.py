"""Simulated time against real time."""

from __future__ import annotations


class Pacer:
    """Real times of simulated times: `speed` simulated seconds a second; 0 is as fast as possible.

    Times are computed from one anchor, so that errors do not accumulate. After a stall longer than `patience` (s) the
    anchor moves: what was missed is not made up for in a rush.
    """

    def __init__(self, speed: float, time: float, now: float, patience: float = 0.25) -> None:
        self._speed = speed
        self._patience = patience
        self.restart(time, now)

    def restart(self, time: float, now: float) -> None:
        """Set simulated `time` to now (s of a steady clock)."""
        self._time = time
        self._now = now

    def wait(self, time: float, now: float) -> float:
        """Return the time (s) from `now` until simulated `time` is due; 0 if it is due."""
        if self._speed <= 0.0:
            return 0.0
        left = self.due(time) - now
        if left < -self._patience:
            self.restart(time, now)
            return 0.0
        return max(0.0, left)

    def due(self, time: float) -> float:
        """Return the time of the steady clock (s) at which a simulated time is due."""
        return self._now + (time - self._time) / self._speed if self._speed > 0.0 else self._now
