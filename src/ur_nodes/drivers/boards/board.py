"""The shape of a driver of a base: a class that turns speeds into bytes, and bytes into readings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol

from ur.robot.base import Base
from ur.robot.base.properties import Wiring
from ur_nodes.drivers.readings import Counts, Reading


class RewiredBoard:
    """See MotorBoard: another board, with the left wheel's speed and counts where the left wheel is."""

    def __init__(self, board: MotorBoard, wiring: Wiring) -> None:
        self._board, self._wiring = board, wiring
        self.name, self.baud, self.period = board.name, board.baud, board.period
        self.counts_per_turn = board.counts_per_turn
        self.handshake, self.stop, self.shutdown = board.handshake, board.stop, board.shutdown

    @property
    def rejected(self) -> int:
        return self._board.rejected

    def drive(self, left: float, right: float) -> bytes:
        return self._board.drive(*self._wiring.command(left, right))

    def receive(self, data: bytes) -> Iterator[Reading]:
        for reading in self._board.receive(data):
            if isinstance(reading, Counts):
                left, right = self._wiring.counted(reading.left, reading.right)
                yield replace(reading, left=left, right=right)
            else:
                yield reading


class MotorBoard(Protocol):
    """The protocol of one kind of board. Nothing here waits, reads a clock, or opens a device."""

    name: str
    """For messages, as "iRobot Create 2"."""
    baud: int
    period: float
    """s between two calls of `drive`."""
    counts_per_turn: float
    """of a wheel"""

    @property
    def rejected(self) -> int:
        """Pieces that began as a frame and were none since the start: damaged ones, and noise."""

    def handshake(self) -> bytes:
        """Return what is sent once the line is open, and again while the device does not answer."""

    def drive(self, left: float, right: float) -> bytes:
        """Return what is sent each period: rim speeds of the wheels, m/s, and the questions that are due."""

    def stop(self) -> bytes:
        """Return what stops the motors at once, also after half a command."""

    def shutdown(self) -> bytes:
        """Return what is sent at the end, after `stop`: the device is left as it was found."""

    def receive(self, data: bytes) -> Iterable[Reading]:
        """Receive bytes as they arrive, and return the readings that they complete. No bytes make it raise."""


@dataclass(frozen=True, slots=True)
class WheelScale:
    """The part of a base that a board needs: the radius of its wheels (m), and counts in a turn."""

    radius: float
    counts_per_turn: float

    @property
    def counts_per_metre(self) -> float:
        """Counts for each m that a wheel rolls."""
        return self.counts_per_turn / (2.0 * math.pi * self.radius)


def scale_of(base: Base, counts_per_turn: float = 0.0) -> WheelScale:
    """The scale of a base; `counts_per_turn` where the board knows better than the base file, which has whole ones."""
    return WheelScale(base.wheels.radius, counts_per_turn or base.odometry.ticks_per_turn)


def clip(value: float, most: int) -> int:
    """The whole number nearest to a value, within -most and most; 0 for no number."""
    return max(-most, min(most, round(value))) if math.isfinite(value) else 0
