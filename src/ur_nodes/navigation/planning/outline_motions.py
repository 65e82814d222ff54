"""Short pieces of motion that a search puts together, and the robot's way to steer that decides which there are."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, TypeAlias

from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.navigation.planning.outline_grid import HEADINGS, STEP

_LENGTH = 0.15  # m: of a straight piece, and of an arc where the robot can turn on the spot
_BENDS = (1, 2, 4)  # headings that arcs change by, where the robot can turn on the spot
_SPIN = 2  # headings of one turn on the spot


@dataclass(frozen=True, slots=True)
class Steering:
    """The steering of a robot: it turns on the spot, or in circles of `radius` m and more; some drive `sideways`.

    `bend` (m) is the radius of a turn at its full speed, 0 unknown.
    """

    radius: float = 0.0
    sideways: bool = False
    bend: float = 0.0

    @property
    def spins(self) -> bool:
        """True when it can turn on the spot."""
        return self.radius <= 0.0


SPINS = Steering()
"""The steering of a robot that turns on the spot."""


LEFT, RIGHT = 2, -2

_COURSES = {1: 0.0, -1: math.pi, LEFT: 0.5 * math.pi, RIGHT: -0.5 * math.pi}
_DIRECTIONS = {1: (1.0, 0.0), -1: (-1.0, 0.0), LEFT: (0.0, 1.0), RIGHT: (0.0, -1.0)}  # without rounding


def course_of(gear: int) -> float:
    """The direction of motion of a gear, rad from the heading."""
    return _COURSES[gear]


def direction_of(gear: int) -> tuple[float, float]:
    """The same as a unit vector: ahead and to the left."""
    return _DIRECTIONS[gear]


def gears_by_turn(yaw: float, bearing: float) -> tuple[int, ...]:
    """All gears to drive at a bearing (rad), that which needs the least turn on the spot first."""
    return tuple(sorted(_COURSES, key=lambda gear: abs(wrap_angle(bearing - _COURSES[gear] - yaw))))


class MotionPose(NamedTuple):
    """A pose on the way (m, m, rad), and the gear that leads there.

    Gears are 1 ahead, -1 back, 0 a turn on the spot, LEFT and RIGHT.
    """

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
def list_pieces(steering: Steering) -> tuple[tuple[MotionPrimitive, ...], ...]:
    """The pieces of a robot that begin with each heading."""
    return tuple(tuple(_pieces_of(heading, steering)) for heading in range(HEADINGS))


def _pieces_of(heading: int, steering: Steering) -> list[MotionPrimitive]:
    pieces, radius = [], steering.radius
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
    if steering.sideways:
        pieces += [_aside(heading, gear) for gear in (LEFT, RIGHT)]
    return pieces


def _aside(heading: int, gear: int) -> MotionPrimitive:
    course = heading * STEP + course_of(gear)
    lengths = (0.5 * _LENGTH, _LENGTH)
    checks = tuple((length * math.cos(course), length * math.sin(course), heading) for length in lengths)
    return MotionPrimitive(*checks[-1][:2], heading, checks, _LENGTH, gear, 0)


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
