"""Inputs of the mux of velocity commands: sources, locks and settings, and the events that it is stepped with."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from ur_nodes.motion.ramp import NO_AXIS, Axis

IDLE = "idle"
_SLOWEST = 1e-4  # m/s, rad/s: less is rounding, not a command to move


@dataclass(frozen=True, slots=True)
class Source:
    """A topic that velocity commands come from. Higher priority wins; `timeout` (s) is its age limit.

    `avoids_obstacles`: its commands come from a program that reads sensors itself, and are not guarded. `foreign`:
    third-party programs send to the topic as if it were the base's, Twist or TwistStamped with any stamp.
    """

    name: str
    topic: str
    priority: int
    timeout: float
    zeros_hold: bool = False
    avoids_obstacles: bool = False
    foreign: bool = False


@dataclass(frozen=True, slots=True)
class Lock:
    """A topic that locks sources of a lower priority, also after `timeout` s without a message.

    With a timeout of 0, messages do not age.
    """

    name: str
    topic: str
    priority: int
    timeout: float


@dataclass(frozen=True, slots=True)
class MuxSettings:
    """Sources, locks, the limits of the base, and the times (s) of the module's docstring."""

    sources: tuple[Source, ...]
    forward: Axis
    turn: Axis
    locks: tuple[Lock, ...] = ()
    period: float = 0.02
    brake_period: float = 0.01
    stop_time: float = 0.3
    lag: float = 0.11
    zeros: int = 3
    forgets: float = 0.1
    left: Axis = NO_AXIS
    brake_after: float | None = None

    def braking_beyond_stop_time(self, speed: float, axis: Axis) -> float:
        """The time (s) beyond `stop_time` that a stop from a speed takes where braking begins after `brake_after`."""
        if self.brake_after is None:
            return 0.0
        return max(0.0, self.brake_after + min(abs(speed), axis.speed) / axis.slow_down - self.stop_time)


class Velocity(NamedTuple):
    """m/s forward, rad/s about z, m/s to the left."""

    forward: float = 0.0
    turn: float = 0.0
    left: float = 0.0

    @property
    def still(self) -> bool:
        """True if there is no motion."""
        return abs(self.forward) < _SLOWEST and abs(self.turn) < _SLOWEST and abs(self.left) < _SLOWEST

    @property
    def finite(self) -> bool:
        """True if all parts are numbers."""
        return math.isfinite(self.forward) and math.isfinite(self.turn) and math.isfinite(self.left)


STILL = Velocity()


class VelocityCommand(NamedTuple):
    """A command of the source with this index, given at the time `at`. Values that are not finite mean a stop.

    `at` is a time of the mux's clock, not an age: a delay of the mux between admission and `step` makes the
    command older. None means the time of the step. A command that is older than the newest of its source is ignored.
    """

    source: int
    velocity: Velocity
    at: float | None = None


@dataclass(frozen=True, slots=True)
class LockMessage:
    """A message of the lock with this index."""

    lock: int
    locked: bool


@dataclass(frozen=True, slots=True)
class EmergencyStopped:
    """Emergency stop: the robot stops until `EmergencyReleased`."""


@dataclass(frozen=True, slots=True)
class EmergencyReleased:
    """End of the emergency stop. Sources that request motion at this moment are ignored until they pause."""


@dataclass(frozen=True, slots=True)
class SpeedLimited:
    """Limit commands to this share (0 to 1) of the base's limits, until the next such event."""

    share: float


Event = VelocityCommand | LockMessage | EmergencyStopped | EmergencyReleased | SpeedLimited


def slow_to(wanted: Velocity, share: float, settings: MuxSettings, speed: float = math.inf) -> Velocity:
    """Return the velocity with at most this share of the base's speeds, and `speed` m/s whichever way, on its curve."""
    planar = math.hypot(wanted.forward, wanted.left)
    if wanted.still or (share >= 1.0 and planar <= speed):
        return wanted
    fastest = max(settings.forward.speed, settings.left.speed)
    part = max(planar / fastest, abs(wanted.forward) / settings.forward.speed, abs(wanted.turn) / settings.turn.speed)
    if wanted.left and settings.left.speed:
        part = max(part, abs(wanted.left) / settings.left.speed)
    factor = min(1.0, share / part, speed / planar if planar else 1.0)
    return Velocity(factor * wanted.forward, factor * wanted.turn, factor * wanted.left)
