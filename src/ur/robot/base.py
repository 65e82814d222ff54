"""What a robot base is: its file `bases/<base>/base.yaml`, read and checked.

The same file feeds the real robot, its URDF and the simulated one. Lengths are in m, masses in kg, angles in rad,
times in s; poses are in `base_footprint` (REP 103 axes: x forward, y left, z up) unless a field says otherwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.section import Section, read_section
from ur.source.suggest import did_you_mean


@dataclass(frozen=True, slots=True)
class Wheels:
    """The two driven wheels, at x = 0 and y = +-separation / 2."""

    radius: float
    width: float
    separation: float
    mass: float


@dataclass(frozen=True, slots=True)
class Caster:
    """A free support: a ball that touches the ground below (x, y)."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Limits:
    """What the base can do: m/s, rad/s, m/s^2, rad/s^2; `command_age` (s) is when an old command means stop.

    The accelerations hold while it speeds up, the decelerations (at least as high; the same unless given) while it
    brakes.
    """

    velocity: float
    angular_velocity: float
    acceleration: float
    angular_acceleration: float
    deceleration: float
    angular_deceleration: float
    command_age: float


@dataclass(frozen=True, slots=True)
class Lidar:
    """A planar lidar. `pose` is x, y, z, roll, pitch, yaw; `noise` the standard deviation of a range."""

    frame: str
    topic: str
    pose: tuple[float, ...]
    angle_min: float
    angle_max: float
    samples: int
    rate: float
    range_min: float
    range_max: float
    noise: float


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera without distortion. `pose` is x, y, z, roll, pitch, yaw of the body: it looks along its x axis.

    `frame` is the optical frame (REP 103: z forward, x right, y down); `name` is the node, and so the namespace of the
    topics. `width` and `height` are in pixels, `field_of_view` is the horizontal angle, `rate` is in images a second.
    """

    frame: str
    name: str
    pose: tuple[float, ...]
    width: int
    height: int
    field_of_view: float
    rate: float

    @property
    def focal_length(self) -> float:
        """Of the pinhole, in pixels, along both axes."""
        return self.width / 2.0 / math.tan(self.field_of_view / 2.0)


@dataclass(frozen=True, slots=True)
class Odometry:
    """How encoder odometry goes wrong: standard deviations, relative to the distance a wheel rolls.

    `wheel_noise` is random per step, in m per sqrt(m) rolled; `radius_error` is the spread of each wheel's fixed
    relative error in radius; `separation_error` that of the wheel separation. All are drawn from the seed.
    """

    rate: float
    ticks_per_turn: int
    wheel_noise: float
    radius_error: float
    separation_error: float


@dataclass(frozen=True, slots=True)
class Base:
    """A base in one variant ('' is the plain one). `footprint` is the outline, counter-clockwise, at least 3 points."""

    name: str
    variant: str
    summary: str
    footprint: tuple[tuple[float, float], ...]
    height: float
    ground_clearance: float
    mass: float
    wheels: Wheels
    casters: tuple[Caster, ...]
    limits: Limits
    odometry: Odometry
    lidar: Lidar | None
    raspicam: Camera | None = None


def list_bases(package: str | Path) -> tuple[str, ...]:
    """The names of the bases that a launch package holds, sorted: its `bases/*/base.yaml`."""
    return tuple(sorted(path.parent.name for path in (Path(package) / "bases").glob("*/base.yaml")))


def load_base(package: str | Path, name: str, variant: str = "") -> Base:
    """Read a base of a launch package. Raises UserError: no such base or variant (did you mean), or a bad file."""
    path = Path(package) / "bases" / name / "base.yaml"
    if not name or not path.is_file():
        names = list_bases(package)
        near = did_you_mean(name, names)
        raise UserError(
            error(
                f"base {name!r} is not known, expected one of {', '.join(names) or '(no base found)'}",
                rule="unknown-base",
                help=f"did you mean {near!r}?"
                if near
                else f"a base is a folder with a base.yaml in {path.parent.parent}",
            )
        )
    return read_base(path, name, variant)


def read_base(path: str | Path, name: str, variant: str = "") -> Base:
    """Read one base file in one variant; the variant's values are laid over the others."""
    whole = read_section(path, "a base file")
    plain = whole.without("variants")
    variants = dict(whole.section("variants").subsections()) if whole.has("variants") else {}
    for overlay in variants.values():
        _base(plain.merged(overlay), name, "")  # a broken variant is a broken file, whichever variant is asked for
    if variant and variant not in variants:
        near = did_you_mean(variant, variants)
        choice = ", ".join(variants) if variants else "none: this base has no variants"
        raise UserError(
            error(
                f"variant {variant!r} of base {name!r} is not known, expected one of {choice}",
                rule="unknown-variant",
                help=f"did you mean {near!r}?" if near else None,
            )
        )
    return _base(plain.merged(variants[variant]) if variant else plain, name, variant)


def list_variants(package: str | Path, name: str) -> tuple[str, ...]:
    """The variants of a base beside the plain one, in the order of its file."""
    whole = read_section(Path(package) / "bases" / name / "base.yaml", "a base file")
    return whole.section("variants").keys if whole.has("variants") else ()


def _base(top: Section, name: str, variant: str) -> Base:
    sensors = top.optional_section("sensors")
    lidar = sensors.optional_section("lidar") if sensors else None
    camera = sensors.optional_section("raspicam") if sensors else None
    base = Base(
        name=name,
        variant=variant,
        summary=top.text("summary"),
        footprint=top.points("footprint", minimum=3),
        height=top.number("height", minimum=0.01),
        ground_clearance=top.number("ground_clearance", minimum=0.001),
        mass=top.number("mass", minimum=0.01),
        wheels=_wheels(top.section("wheels")),
        casters=tuple(_caster(item) for item in top.sections("casters")),
        limits=_limits(top.section("limits")),
        odometry=_odometry(top.section("odometry")),
        lidar=_lidar(lidar) if lidar else None,
        raspicam=_camera(camera) if camera else None,
    )
    if sensors:
        sensors.finish()
    top.finish()
    return base


def _wheels(part: Section) -> Wheels:
    wheels = Wheels(
        radius=part.number("radius", minimum=0.005),
        width=part.number("width", minimum=0.001),
        separation=part.number("separation", minimum=0.02),
        mass=part.number("mass", minimum=0.001),
    )
    part.finish()
    return wheels


def _caster(part: Section) -> Caster:
    caster = Caster(part.number("x"), part.number("y"), part.number("radius", minimum=0.001))
    part.finish()
    return caster


def _limits(part: Section) -> Limits:
    acceleration = part.number("acceleration", minimum=0.01)
    angular_acceleration = part.number("angular_acceleration", minimum=0.01)
    limits = Limits(
        velocity=part.number("velocity", minimum=0.01),
        angular_velocity=part.number("angular_velocity", minimum=0.01),
        acceleration=acceleration,
        angular_acceleration=angular_acceleration,
        deceleration=part.number("deceleration", acceleration, minimum=acceleration),
        angular_deceleration=part.number("angular_deceleration", angular_acceleration, minimum=angular_acceleration),
        command_age=part.number("command_age", minimum=0.02, maximum=1.0),
    )
    part.finish()
    return limits


def _lidar(part: Section) -> Lidar:
    lidar = Lidar(
        frame=part.text("frame"),
        topic=part.text("topic", "scan"),
        pose=part.numbers("pose", 6),
        angle_min=part.number("angle_min"),
        angle_max=part.number("angle_max"),
        samples=part.integer("samples", minimum=2),
        rate=part.number("rate", minimum=0.1),
        range_min=part.number("range_min", minimum=0.0),
        range_max=part.number("range_max", minimum=0.01),
        noise=part.number("noise", minimum=0.0),
    )
    if lidar.angle_max <= lidar.angle_min:
        part.fail("angle_max", f"angle_max: {lidar.angle_max:g} in {part.name}, expected more than angle_min")
    part.finish()
    return lidar


def _camera(part: Section) -> Camera:
    camera = Camera(
        frame=part.text("frame", "raspicam"),
        name=part.text("name", "raspicam_node"),
        pose=part.numbers("pose", 6),
        width=part.integer("width", minimum=16),
        height=part.integer("height", minimum=16),
        field_of_view=part.number("field_of_view", minimum=0.1, maximum=2.6),
        rate=part.number("rate", minimum=0.1, maximum=200.0),
    )
    part.finish()
    return camera


def _odometry(part: Section) -> Odometry:
    odometry = Odometry(
        rate=part.number("rate", minimum=1.0),
        ticks_per_turn=part.integer("ticks_per_turn", minimum=1),
        wheel_noise=part.number("wheel_noise", minimum=0.0),
        radius_error=part.number("radius_error", minimum=0.0),
        separation_error=part.number("separation_error", minimum=0.0),
    )
    part.finish()
    return odometry
