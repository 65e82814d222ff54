"""A schedule of periodic events, counted in time steps."""

from __future__ import annotations

import math

from ur_nodes.simulator.model import TIME_STEP


class Schedule:
    """Something that happens at a rate (Hz), each time at the first time step that is not too early."""

    def __init__(self, rate: float, after: int = 0) -> None:
        """The first time is the one after step `after`."""
        self._steps = 1.0 / (rate * TIME_STEP)
        self._number = math.floor(after / self._steps + 1e-6) + 1
        self.step = max(after + 1, self._step_of(self._number))

    def take(self, step: int) -> bool:
        """Return True when the event is due at a step, and schedule the next one."""
        if step < self.step:
            return False
        self._number += 1
        self.step = max(step + 1, self._step_of(self._number))
        return True

    def _step_of(self, number: int) -> int:
        return math.ceil(number * self._steps - 1e-6)
