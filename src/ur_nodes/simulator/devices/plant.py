"""A simulated robot as its devices know it: wheels with encoders, battery, switches, and the beams of its lidar."""

import math
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.simulator.mujoco_model import TIME_STEP
from ur_nodes.simulator.sensors.battery import BatterySense
from ur_nodes.simulator.sensors.bumpers import BumperSense
from ur_nodes.simulator.sensors.cliffs import CliffSense
from ur_nodes.simulator.sensors.sonars import SonarSense
from ur_nodes.simulator.simulation import Simulation


class Plant:
    """One robot of a simulation, whose wheels devices turn. `update` is called at each tick, before it is asked.

    Each wheel's radius is off by a fixed error drawn once, and what it rolls by a random one, as `Base.odometry` says.
    """

    def __init__(self, simulation: Simulation, robot: int, seed: int) -> None:
        self.base: Base = simulation.base
        self._simulation, self._robot = simulation, robot
        self._random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, robot, 0xD])))
        errors = self._random.standard_normal(2) * self.base.odometry.radius_error
        self._radii = (1.0 + errors) * self.base.wheels.radius
        self._angles = np.array(simulation.wheel_angles(robot))
        self._rolled = np.zeros(2)
        self._yaw = simulation.pose(robot).yaw
        self.drift = 0.0, 0.0
        """By how much (rad) the lidar pointed elsewhere than `ranges` do, at the last tick and now."""
        self.time = simulation.time
        simulation.control_wheels(robot)

    def update(self) -> None:
        """The simulation went on."""
        now = np.array(self._simulation.wheel_angles(self._robot))
        rolled = (now - self._angles) * self._radii
        noise = self._random.standard_normal(2) * self.base.odometry.wheel_noise * np.sqrt(np.abs(rolled))
        self._rolled += rolled + noise
        yaw, seconds = self._simulation.pose(self._robot).yaw, self._simulation.time - self.time
        turned = wrap_angle(yaw - self._yaw) * (self.base.lidar.upright if self.base.lidar else 1.0)
        behind = turned * TIME_STEP / max(seconds, TIME_STEP)  # ranges are those from where the last time step began
        self.drift = behind - turned, behind
        self._yaw, self._angles, self.time = yaw, now, self._simulation.time

    def turn_wheels(self, left: float, right: float) -> None:
        """Have the rims of the wheels move, m/s; 0.0 for no number."""
        speeds = [each / self.base.wheels.radius if math.isfinite(each) else 0.0 for each in (left, right)]
        self._simulation.turn_wheels(self._robot, *speeds)

    def rolled(self) -> tuple[float, float]:
        """Return what the encoders of the left and right wheel have measured since the start, m."""
        return float(self._rolled[0]), float(self._rolled[1])

    def battery(self) -> tuple[float, float, float, float]:
        """Return voltage (V), current (A, negative: discharging), charge and capacity (Ah); zeros without a battery."""
        if self.base.battery is None:
            return 0.0, 0.0, 0.0, 0.0
        charge = self._simulation.senses[self._robot].find(BatterySense).charge
        return charge.voltage, charge.current, charge.charge, self.base.battery.design_capacity

    def bumpers(self) -> dict[str, bool]:
        """Return by name which bumpers are pressed."""
        if self.base.bumpers is None:
            return {}
        return self._simulation.senses[self._robot].find(BumperSense).pressed(self.time)

    def cliffs(self) -> dict[str, bool]:
        """Return by name which cliff sensors see no floor."""
        return self._simulation.senses[self._robot].find(CliffSense).seen() if self.base.cliffs else {}

    def sonars(self) -> list[float]:
        """Return what the sonars measure now (m), in the order of the base's file; see SonarRing.listen."""
        if self.base.sonars is None:
            return []
        return [float(each) for each in self._simulation.senses[self._robot].find(SonarSense).ranges()]

    def ranges(self) -> npt.NDArray[np.float64]:
        """Return the ranges of the lidar now (m), from its `angle_min` on; see LidarBeams.cast."""
        return self._simulation.scan(self._robot)


class Firmware(Protocol):
    """The behaviour of a device at the end of a line; `covers` are the keys of sensors that it reports."""

    covers: frozenset[str]

    def receive(self, data: bytes) -> bytes:
        """Receive bytes of the driver, and return the answers. No bytes make it raise."""

    def tick(self) -> bytes:
        """Return what the device sends by itself until now."""
