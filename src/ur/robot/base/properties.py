"""A base as data: body, wheels, motion limits, sensors and drivers."""

import math
from dataclasses import dataclass, field, fields, replace

from ur.robot.base.sensors import Sensors

BRAKE_AFTER = 0.2
"""s after the last command that arrived, after which the wheels of a `fast` base brake at the latest."""
_SHORT = 0.15  # s: a stop of this length, and what passes until it begins, are within 0.3 s


@dataclass(frozen=True, slots=True)
class Wiring:
    """Swapped and reversed wires between a board and the wheels, left and right of the robot; by default none.

    `motors_swapped`: the board's left motor output turns the right wheel, and the reverse; `counters_swapped` likewise.
    A reversed motor turns its wheel backward for a positive speed; a reversed counter counts down forward.
    """

    motors_swapped: bool = False
    left_motor_reversed: bool = False
    right_motor_reversed: bool = False
    counters_swapped: bool = False
    left_counter_reversed: bool = False
    right_counter_reversed: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what differs."""
        return tuple(name for name in WIRING_NAMES if getattr(self, name))

    def command(self, left: float, right: float) -> tuple[float, float]:
        """Return the speeds that the board gets, for those of the wheels."""
        left = -left if self.left_motor_reversed else left
        right = -right if self.right_motor_reversed else right
        return (right, left) if self.motors_swapped else (left, right)

    def counted(self, left: int, right: int) -> tuple[int, int]:
        """Return the counts of the wheels, for those that the board reports."""
        left, right = (right, left) if self.counters_swapped else (left, right)
        return -left if self.left_counter_reversed else left, -right if self.right_counter_reversed else right


WIRING_NAMES = tuple(field.name for field in fields(Wiring))


@dataclass(frozen=True, slots=True)
class Wheels:
    """The two driven wheels, at x = 0 and y = +-separation / 2."""

    radius: float
    width: float
    separation: float
    mass: float


@dataclass(frozen=True, slots=True)
class Caster:
    """A passive support: a ball that touches the ground below (x, y)."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Limits of motion in m/s, rad/s, m/s^2 and rad/s^2.

    `command_age` (s) is the age above which a command no longer moves the robot. The accelerations apply while it
    speeds up, the decelerations (at least as high; equal unless given) while it brakes. `lag` (s) is the delay between
    a command and the response of the wheels, without the braking time. `lateral_velocity` is the greatest speed to
    either side, 0 for a base whose wheels do not roll sideways; the accelerations to the side are those ahead.
    """

    velocity: float
    angular_velocity: float
    acceleration: float
    angular_acceleration: float
    deceleration: float
    angular_deceleration: float
    command_age: float
    lag: float
    lateral_velocity: float = 0.0

    @property
    def sideways(self) -> bool:
        """True if the wheels roll sideways, too."""
        return self.lateral_velocity > 0.0

    @property
    def fast(self) -> bool:
        """True if it cannot stop from its full speed within 0.3 s of its last command."""
        turns = self.angular_velocity / self.angular_deceleration
        return max(max(self.velocity, self.lateral_velocity) / self.deceleration, turns) > _SHORT

    @property
    def way_to_rest(self) -> float:
        """The way (m) that it drives at most after the last command: 0.2 v + v^2 / 2a at its full speed v."""
        speed = max(self.velocity, self.lateral_velocity)
        return BRAKE_AFTER * speed + speed * speed / (2.0 * self.deceleration)

    def within_sight(self, sight: float) -> "MotionLimits":
        """Return the limits with which a fast base rests within what its lidar sees, `sight` (m) from its outline."""
        if not self.fast or self.way_to_rest <= sight:
            return self
        a, t = self.deceleration, BRAKE_AFTER  # solve t v + v^2 / 2a = sight for v
        most = a * (math.sqrt(t * t + 2.0 * max(0.0, sight) / a) - t)
        return replace(self, velocity=min(self.velocity, most), lateral_velocity=min(self.lateral_velocity, most))

    def describe_stop(self) -> str:
        """Say for users how it stops when commands cease: "brakes within 0.2 s of its last command, ..."."""
        speed = max(self.velocity, self.lateral_velocity)
        if self.fast:
            rest = f"brakes within {BRAKE_AFTER:g} s of its last command, and rests within {self.way_to_rest:.2g} m"
        else:
            rest = f"rests within 0.3 s and {self.way_to_rest:.2g} m of its last command"
        return f"{rest}, from {speed:g} m/s"


@dataclass(frozen=True, slots=True)
class OdometryErrors:
    """Errors of encoder odometry: standard deviations, relative to the distance a wheel rolls.

    `wheel_noise` is random per step, in m per sqrt(m) rolled; `radius_error` is the spread of each wheel's fixed
    relative error in radius; `separation_error` that of the wheel separation. All are drawn from the seed.
    """

    rate: float
    ticks_per_turn: int
    wheel_noise: float
    radius_error: float
    separation_error: float


@dataclass(frozen=True, slots=True)
class UpstreamDriver:
    """The upstream node for a piece of hardware: `part` is 'base', or the sensor that it reads.

    `node` is the launch directory that starts it ('' when there is none), `device` where the hardware is ('' when it is
    no device file), `baud` its speed (0 when that means nothing), `install` one line on how to get the package,
    `hardware` its id in the table of known devices (`ur.devices.known`; '' when it has none). `protocol` is the name of
    a driver of this project (`ur.robot.base.own_drivers`), '' for upstream's; `wiring` is what differs from the wiring
    that its board expects.
    """

    part: str
    node: str
    package: str
    executable: str
    device: str
    baud: int
    install: str
    hardware: str = ""
    protocol: str = ""
    wiring: Wiring = field(default_factory=Wiring)


@dataclass(frozen=True, slots=True)
class Base(Sensors):
    """A base in one variant ('' is the plain one). `footprint` is the outline, counter-clockwise, at least 3 points.

    `driver` is None for a base that exists in simulation only; `drivers` are those of sensors that have a separate
    driver. `body` is the outline of the body alone, where wheels protrude from it (empty: the footprint)and is used for
    display only.
    """

    name: str
    variant: str
    summary: str
    footprint: tuple[tuple[float, float], ...]
    height: float
    ground_clearance: float
    mass: float
    wheels: Wheels
    casters: tuple[Caster, ...]
    limits: MotionLimits
    odometry: OdometryErrors
    driver: UpstreamDriver | None = None
    drivers: tuple[UpstreamDriver, ...] = ()
    body: tuple[tuple[float, float], ...] = ()
