"""Periodic events of a simulation, in whole time steps."""

import math
from dataclasses import dataclass

from ur_nodes.simulator.mujoco_model import TIME_STEP


class Schedule:
    """A periodic event at a rate (Hz), due each time at the first time step that is not too early."""

    def __init__(self, rate: float, after: int = 0) -> None:
        """The first time is the one after step `after`."""
        self._steps = 1.0 / (rate * TIME_STEP)
        self._number = math.floor(after / self._steps + 1e-6) + 1
        self.step = max(after + 1, self._step_of(self._number))

    def consume(self, step: int) -> bool:
        """Return True when the event is due at a step, and schedule the next one."""
        if step < self.step:
            return False
        self._number += 1
        self.step = max(step + 1, self._step_of(self._number))
        return True

    def _step_of(self, number: int) -> int:
        return math.ceil(number * self._steps - 1e-6)


@dataclass(frozen=True, slots=True)
class SimulationTick:
    """All that is due at a time (s since the start): control, odometry, scan, picture, and sensors by key."""

    time: float
    due: frozenset[str]
    moved: bool = False
    """True: something in it comes with the robot's place."""
