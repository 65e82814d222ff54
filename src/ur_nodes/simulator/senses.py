"""The sensors of one robot beside lidar and camera: a module in `sensors` for each key of `ur.robot.base.SENSORS`."""

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TypeVar
from zlib import crc32

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.robot.base.sensors import Sensor
from ur.worlds.world_file import Drop
from ur_nodes.simulator.physics import Physics
from ur_nodes.simulator.sensors.sense import Sense, Site

_ELSEWHERE = ("lidar", "raspicam")  # they are drawn for all robots at once
_Kind = TypeVar("_Kind", bound=Sense)


class Senses:
    """Sensors of one robot, as far as its base has them, by key."""

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
        self.each = {
            name: _load(name)(part, Site(base, physics, robot, _draw_key(seed, name), drops, charge))
            for name, part in base.list_sensors()
            if name not in _ELSEWHERE
        }

    def find(self, kind: type[_Kind]) -> _Kind:
        """The sensor of a kind. Raises StopIteration: the base has none."""
        return next(each for each in self.each.values() if isinstance(each, kind))

    def begin(self) -> None:
        """The simulation is reset."""
        for each in self.each.values():
            each.begin()

    def sample(self, due: Sequence[str], time: float) -> None:
        """These sensors are due, at a time (s) since the start or the last reset."""
        for name in due:
            self.each[name].sample(time)

    def feel_touch(self, time: float) -> None:
        """The robot touches something at a time (s)."""
        for each in self.each.values():
            each.feel_touch(time)

    def forget_motion(self) -> None:
        """The robot was put elsewhere by hand."""
        for each in self.each.values():
            each.forget_motion()


def _load(name: str) -> Callable[[Sensor, Site], Sense]:
    """The model of the sensor with a key of `ur.robot.base.SENSORS`: `SENSE` of the module with this name."""
    sense: Callable[[Sensor, Site], Sense] = import_module(f"ur_nodes.simulator.sensors.{name}").SENSE
    return sense


def _draw_key(seed: np.random.SeedSequence, name: str) -> npt.NDArray[np.uint64]:
    """A stream for each sensor, so that one sensor more does not change the readings of the others."""
    own = np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, crc32(name.encode())))
    return own.generate_state(2, np.uint64).astype(np.uint64, copy=False)
