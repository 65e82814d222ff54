"""Sensors of one robot beside lidar and camera: sonars, bumpers, cliff sensors, inertial unit and battery."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.worlds.world_file import Drop
from ur_nodes.simulator.physics import Physics
from ur_nodes.simulator.sensors.battery import BatteryCharge
from ur_nodes.simulator.sensors.bumpers import BumperRing
from ur_nodes.simulator.sensors.cliffs import see_drops
from ur_nodes.simulator.sensors.imu import ImuReading, InertialUnit
from ur_nodes.simulator.sensors.rays import Floats

BATTERY_RATE = 1.0  # Hz


class Senses:
    """Sensors of one robot, as far as its base has them. Their noise does not depend on subscribers."""

    def __init__(
        self,
        base: Base,
        physics: Physics,
        robot: int,
        seed: np.random.SeedSequence,
        charge: float,
        drops: Sequence[Drop] = (),
    ) -> None:
        """`charge` is how full the battery is at first, 0 to 1."""
        self._base = base
        self._physics = physics
        self._robot = robot
        self._drops = drops
        # A stream each, so that one sensor more does not change the readings of the others.
        self._sonar_key, self._imu_key = (each.generate_state(2, np.uint64) for each in seed.spawn(2))
        self._heard = self._felt = 0
        self._imu = InertialUnit(base.imu) if base.imu else None
        self._bumpers = BumperRing(base.bumpers) if base.bumpers else None
        self._battery = BatteryCharge(base.battery, charge) if base.battery else None
        self._rolled = physics.wheel_angles(robot)
        self.feel_motion(0.0)

    def listen(self) -> None:
        """The sonars are due."""
        self._heard += 1

    def feel_motion(self, time: float) -> None:
        """The inertial unit is due, at a time (s) since the start or the last reset."""
        if self._imu:
            self._imu.sample(self._physics.motion(self._robot), time)
            self._felt += 1

    def feel_touch(self, time: float) -> None:
        """The robot touches something at a time (s)."""
        if self._bumpers:
            self._bumpers.press(self._physics.touches(self._robot), time)

    def drain(self) -> None:
        """The battery is due: it gave what the wheels took since it last was."""
        if self._battery:
            rolled = self._physics.wheel_angles(self._robot)
            turned = sum(abs(now - then) for now, then in zip(rolled, self._rolled, strict=True)) / 2.0
            self._rolled = rolled
            speed = turned * self._base.wheels.radius * BATTERY_RATE
            self._battery.draw(min(1.0, speed / self._base.limits.velocity), 1.0 / BATTERY_RATE)

    def forget_motion(self) -> None:
        """The robot was put elsewhere by hand."""
        if self._imu:
            self._imu.forget()

    def ranges(self) -> Floats:
        """Return the ranges of the sonars (m), in the order of the base's file; see SonarRing.listen."""
        count = len(self._base.sonars.at) if self._base.sonars else 0
        return self._physics.listen(self._robot, draw_noise(self._sonar_key, self._heard, count))

    def inertia(self) -> ImuReading | None:
        """Return the newest reading of the inertial unit; None for a base without one."""
        return self._imu.read(draw_noise(self._imu_key, self._felt, 6)) if self._imu else None

    def pressed(self, time: float) -> dict[str, bool]:
        """Return the states of the bumpers at a time (s), by name."""
        return self._bumpers.state(time) if self._bumpers else {}

    def cliffs(self) -> dict[str, bool]:
        """Return by name which cliff sensors see no floor."""
        return see_drops(self._base.cliffs, self._drops, self._physics.pose(self._robot)) if self._base.cliffs else {}

    @property
    def battery(self) -> BatteryCharge | None:
        """The battery; None for a base without one."""
        return self._battery


def draw_noise(key: npt.NDArray[np.uint64], number: int, size: int) -> Floats:
    """Standard normal numbers, shape (size,): always the same ones for a key (shape (2,)) and a number of a reading."""
    return np.random.Generator(np.random.Philox(key=key, counter=number << 64)).standard_normal(size)
