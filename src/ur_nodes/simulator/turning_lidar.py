"""A lidar whose head turns while it measures: beam after beam, each from where the robot is by then."""

import math

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.simulator.mujoco_model import TIME_STEP
from ur_nodes.simulator.simulation import Simulation

_PLACED = 0.5  # rad between two ticks: the robot was put there by hand
_WITHOUT = 1.5  # turns: the last scans had no subscriber


def direction_of(base: Base) -> int:
    """Return 1 where the lidar of a base turns counter-clockwise, -1 clockwise, in its frame; 0: it has no real one."""
    drivers = [driver.protocol for driver in base.drivers if driver.part == "lidar"]
    drivers += [base.driver.protocol] if base.driver and base.driver.protocol == "neato" else []
    if not (base.lidar and drivers):
        return 0
    own = OWN_DRIVERS.get(drivers[0])
    return -1 if own and own.clockwise else 1


class TurningLidar:
    """The head of a robot's lidar, which ends a turn with each scan that is due. `measure` is called at each tick."""

    def __init__(self, simulation: Simulation, robot: int = 0) -> None:
        assert simulation.base.lidar
        self._simulation, self._robot, self._lidar = simulation, robot, simulation.base.lidar
        self._clockwise = direction_of(simulation.base) < 0
        self._step = (self._lidar.angle_max - self._lidar.angle_min) / (self._lidar.samples - 1)
        self._size = max(self._lidar.samples, round(2.0 * math.pi / self._step))  # beams of a turn
        self._distances = np.full(self._lidar.samples, np.inf)
        self._yaw = self._time = 0.0  # rad, s: at the last tick
        self._beam = 0  # the next one of this turn
        self._begun = -1.0  # s; negative before the first turn
        self.first = self.increment = 0.0
        """When the first beam of the newest scan was measured (s), and the time from one to the next (s)."""

    def measure(self, *, due: bool) -> npt.NDArray[np.float64] | None:
        """Measure until now; return the ranges (samples,) of the turn if a scan is due, None before it is complete."""
        now, yaw = self._simulation.time, self._simulation.pose(self._robot).yaw
        turned, passed = self._lidar.upright * wrap_angle(yaw - self._yaw), now - self._time
        self._yaw, self._time = yaw, now
        if now - self._begun > _WITHOUT / self._lidar.rate:
            self._begun = -1.0
        if self._begun >= 0.0:
            share = 1.0 if due else min(1.0, (now - self._begun) * self._lidar.rate)
            self._pass_beams(int(share * self._size), turned if abs(turned) < _PLACED else 0.0, passed)
        if not due:
            return None
        begun, self._begun, self._beam = self._begun, now, 0
        if begun < 0.0:
            return None
        spacing = (now - begun) / self._size
        self.first = begun + (self._lidar.samples - 1) * spacing if self._clockwise else begun
        self.increment = -spacing if self._clockwise else spacing
        return self._simulation.measured(self._robot, self._distances)

    def _pass_beams(self, end: int, turned: float, seconds: float) -> None:
        """Measure the beams of this turn up to `end`; the robot has `turned` (rad) meanwhile, in so many `seconds`."""
        begin, self._beam, samples = self._beam, end, self._lidar.samples
        count = min(end, samples) - begin
        if count <= 0:
            return
        step = turned / (end - begin)  # of the robot from beam to beam
        if self._clockwise:
            low = samples - begin - count
            first, step = self._lidar.angle_max - (begin + count - 1) * self._step + (count - 0.5) * step, -step
        else:
            low = begin
            first = self._lidar.angle_min + begin * self._step + 0.5 * step
        behind = TIME_STEP / max(seconds, TIME_STEP)  # beams are cast from where the last time step began
        found = self._simulation.cast(self._robot, first - (1.0 - behind) * turned, self._step + step, count)
        self._distances[low : low + count] = found
