"""A robot with its wheels off the ground, wired in any way, at the end of a line whose time is counted."""

from typing import Any

from tests.ur_nodes.drivers.mutations import StillPlant

from ur.robot.base.wiring import Wiring
from ur_nodes.drivers.registry import FIRMWARES

TICK = 0.01  # s


class LiftedPlant(StillPlant):
    """Wheels that turn at once. `motions` are the directions of the left and right wheel, while they turned."""

    def __init__(self, wiring: Wiring) -> None:
        super().__init__()
        self.wiring, self.stuck = wiring, (False, False)
        self._speeds, self._wheels = (0.0, 0.0), [0.0, 0.0]
        self.last = (0, 0)

    def turn_wheels(self, left: float, right: float) -> None:
        left, right = self.wiring.turned(left, right)
        self._speeds = (0.0 if self.stuck[0] else left, 0.0 if self.stuck[1] else right)

    def advance(self, seconds: float) -> None:
        self.time += seconds
        for index, speed in enumerate(self._speeds):
            self._wheels[index] += speed * seconds
        if any(abs(speed) > 0.01 for speed in self._speeds):
            left, right = ((speed > 0.01) - (speed < -0.01) for speed in self._speeds)
            self.last = (left, right)

    def rolled(self) -> tuple[float, float]:
        left, right = self._wheels
        left = -left if self.wiring.left_counter_reversed else left
        right = -right if self.wiring.right_counter_reversed else right
        return (right, left) if self.wiring.counters_swapped else (left, right)


class CountedLine:
    """See TimedLine."""

    name = "/dev/test"

    def __init__(self, board: str, wiring: Wiring) -> None:
        self.plant = LiftedPlant(wiring)
        self.firmware: Any = FIRMWARES[board](self.plant)  # type: ignore[arg-type]

    def time(self) -> float:
        return self.plant.time

    def exchange(self, data: bytes, seconds: float, *, moving: bool) -> bytes:  # noqa: ARG002 - of the protocol
        received: bytes = self.firmware.receive(data)
        for _ in range(round(seconds / TICK)):
            self.plant.advance(TICK)
            received += self.firmware.tick()
        return received
