"""Heads of simulated lidars: the beams that a head has passed since the last tick, for a stand-in to send."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

_PER_TURN = 360  # beams, a degree apart
_MOST = 180  # beams of a tick, after a stall
_JOINED = 0.05  # of the range: between beams that differ by less there is one surface


class TurningHead(ABC):
    """A head that turns at the rate of the base file and measures once a degree, counted from its own zero."""

    covers = frozenset(("lidar",))
    clockwise = True
    turns = True
    """False: the head rests."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        lidar = plant.base.lidar
        assert lidar is not None  # the bench gives lidars to bases that have one
        self._lidar = lidar
        self._step = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        self._time = plant.time
        self._beam = 0  # the next one, counted from the start

    @abstractmethod
    def receive(self, data: bytes) -> bytes:
        """See Firmware."""

    @abstractmethod
    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        """The bytes for beams, by their numbers since the start; 0.0 mm: nothing was measured."""

    def tick(self) -> bytes:
        rate = self._lidar.rate * _PER_TURN
        count = int((self._plant.time - self._time) * rate + 1e-6)
        self._time += count / rate
        if not count or not self.turns:
            return b""
        beams = self._beam + np.arange(count)[-_MOST:]
        self._beam += count
        return self.pack(beams, self.measure(beams))

    def measure(self, beams: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """The distances (n,) in mm of beams (n,) by their numbers."""
        return self.look(np.radians(beams % _PER_TURN))

    def look(self, phases: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The distances (n,) in mm where the head has turned by so much (n,); 0.0: nothing is in reach.

        It has done so one after the other since the last tick, on a robot that turned meanwhile.
        """
        drift = np.linspace(*self._plant.drift, 2 * len(phases) + 1)[1::2]
        angles = (-phases if self.clockwise else phases) + drift - self._lidar.angle_min
        index, size = angles % (2.0 * math.pi) / self._step, round(2.0 * math.pi / self._step)
        nearest = np.rint(index).astype(np.int64) % size
        inside, seen = nearest < self._lidar.samples, np.full(size + 1, np.inf)
        seen[: self._lidar.samples] = self._plant.ranges()
        seen[-1] = seen[0]
        ranges = seen[nearest]
        with np.errstate(invalid="ignore"):
            between = np.interp(index, np.arange(size + 1), seen)
            ranges = np.where(np.abs(between - ranges) < _JOINED * ranges, between, ranges)
        return np.where(inside & np.isfinite(ranges), ranges * 1000.0, 0.0)


class PacketHead(TurningHead):
    """A head that listens to nothing, and sends packets of `size` beams."""

    size: ClassVar[int]

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._waiting: list[tuple[int, float]] = []

    @abstractmethod
    def packet(self, points: Sequence[tuple[int, float]]) -> bytes:
        """The bytes of a packet of beams, each its number since the start and a distance in mm."""

    def receive(self, data: bytes) -> bytes:
        return data[:0]

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        self._waiting += zip(beams.tolist(), millimetres.tolist(), strict=True)
        sent = b""
        while len(self._waiting) >= self.size:
            sent += self.packet(self._waiting[: self.size])
            del self._waiting[: self.size]
        return sent
