"""A sensor of one simulated robot: sampled at its rate, sent while its topics have subscribers."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.worlds.world_file import Drop
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.simulator.physics import Physics
from ur_nodes.simulator.sensors.flat_rays import Floats

Send = Callable[[float, int], None]
"""Sends a reading: the simulated time (s), and the stamp of messages (ns)."""


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """The place of a sensor: on a robot (`robot` by number) of a base, in a world with drops.

    `key` (shape (2,)) makes its noise, `charge` is how full the battery is at first, 0 to 1.
    """

    base: Base
    physics: Physics
    robot: int
    key: npt.NDArray[np.uint64]
    drops: Sequence[Drop]
    charge: float


class Sense(ABC):
    """The model of a sensor. Its noise does not depend on subscribers."""

    rate = 0.0
    """Readings a second; 0.0: with every step of the simulation."""
    placed = False
    """True: a reading comes with the robot's place."""

    def begin(self) -> None:  # noqa: B027 - most of these are no matter of most sensors
        """The simulation starts, or is reset."""

    def sample(self, time: float) -> None:  # noqa: B027
        """The sensor is due, at a time (s) since the start or the last reset."""

    def feel_touch(self, time: float) -> None:  # noqa: B027
        """The robot touches something at a time (s)."""

    def forget_motion(self) -> None:  # noqa: B027
        """The robot was put elsewhere by hand."""

    @abstractmethod
    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:
        """Open its topics. `prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'."""


class Noise:
    """Standard normal numbers: always the same ones for a key (shape (2,)) and the number of a reading."""

    def __init__(self, key: npt.NDArray[np.uint64]) -> None:
        self._bits = np.random.Philox(key=key)
        self._generator = np.random.Generator(self._bits)
        self._first = self._bits.state

    def draw(self, number: int, size: int) -> Floats:
        """Return those of a reading, shape (size,)."""
        self._first["state"]["counter"][1] = number  # a tenth of the time that a new generator takes
        self._bits.state = self._first
        return self._generator.standard_normal(size)


def open_switches(node: Node, topics: Mapping[str, str], read: Callable[[float], dict[str, bool]]) -> Send:
    """Open a latched topic for each switch, on which its state is sent when it changes; `topics` are by name."""
    publishers = {name: node.publish(topic, bool, Quality.LATCHED) for name, topic in topics.items()}
    sent: dict[str, bool] = {}

    def send(time: float, _stamp: int) -> None:
        for name, state in read(time).items():
            if sent.get(name) is not state:
                sent[name] = state
                publishers[name].send(state)

    return send
