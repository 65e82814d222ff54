"""Short pieces of motion that a search puts together, and the robot's way to steer that decides which there are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, TypeAlias

from ur_nodes.navigation.planning.outline_grid import HEADINGS, STEP

_LENGTH = 0.15  # m: of a straight piece, and of an arc where the robot can turn on the spot
_BENDS = (1, 2, 4)  # headings that arcs change by, where the robot can turn on the spot
_SPIN = 2  # headings of one turn on the spot


@dataclass(frozen=True, slots=True)
class Steering:
    """The steering of a robot: it turns on the spot, or in circles of `radius` m and more."""

    radius: float = 0.0

    @property
    def spins(self) -> bool:
        """True when it can turn on the spot."""
        return self.radius <= 0.0


SPINS = Steering()
"""The steering of a robot that turns on the spot."""


class MotionPose(NamedTuple):
    """A pose on the way (m, m, rad), and the gear that leads there: 1 ahead, -1 back, 0 a turn on the spot."""

    x: float
    y: float
    yaw: float
    gear: int


Motions: TypeAlias = tuple[MotionPose, ...]


class MotionPrimitive(NamedTuple):
    """A piece from the origin: its end, poses between with the end, length (m), gear, headings turned."""

    dx: float
    dy: float
    heading: int
    checks: tuple[tuple[float, float, int], ...]
    length: float
    gear: int
    turned: int


@lru_cache(maxsize=4)
def list_pieces(radius: float) -> tuple[tuple[MotionPrimitive, ...], ...]:
    """The pieces of a robot that begin with each heading."""
    return tuple(tuple(_pieces_of(heading, radius)) for heading in range(HEADINGS))


def _pieces_of(heading: int, radius: float) -> list[MotionPrimitive]:
    pieces = []
    if radius > 0.0:
        bends = [(turned, max(_LENGTH, abs(turned) * STEP * radius * 1.001)) for turned in (1, 2)]
    else:
        bends = [(turned, _LENGTH) for turned in _BENDS]
    for gear in (1, -1):
        pieces.append(_arc(heading, 0, _LENGTH, gear))
        for turned, length in bends:
            pieces += [_arc(heading, turned, length, gear), _arc(heading, -turned, length, gear)]
    if radius <= 0.0:
        for turned in (_SPIN, -_SPIN):
            sign = 1 if turned > 0 else -1
            numbers = [(heading + sign * step) % HEADINGS for step in range(1, _SPIN + 1)]
            checks = tuple((0.0, 0.0, number) for number in numbers)
            pieces.append(MotionPrimitive(0.0, 0.0, numbers[-1], checks, 0.0, 0, turned))
    return pieces


def _arc(heading: int, turned: int, length: float, gear: int) -> MotionPrimitive:
    count = max(2, abs(turned), math.ceil(length / 0.08))
    checks = []
    for step in range(1, count + 1):
        share = step / count
        swing = turned * STEP * share * gear
        along = gear * length * share
        chord = along if turned == 0 else along * math.sin(swing / 2.0) / (swing / 2.0)
        middle = heading * STEP + swing / 2.0
        number = round(heading + turned * gear * share) % HEADINGS
        checks.append((chord * math.cos(middle), chord * math.sin(middle), number))
    dx, dy, end = checks[-1]
    return MotionPrimitive(dx, dy, end, tuple(checks), length, gear, turned * gear)
