"""Reader of base files. Every function raises UserError, with file, line and column, for an invalid value."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from ur.devices.known import find_rows, load_known
from ur.robot.base.outline import Point, find_crossing, is_inside, measure_area
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.robot.base.properties import (
    WIRING_NAMES,
    Base,
    Caster,
    MotionLimits,
    OdometryErrors,
    UpstreamDriver,
    Wheels,
    Wiring,
)
from ur.robot.base.sensors import Sensor, read_sensors
from ur.source.section import Section
from ur.source.suggest import did_you_mean

_TOLERANCE = 0.001  # m
_OWN_DEVICE = r"/dev/[\w./:-]+|tcp://[\w.-]+:\d{1,5}"


def read_whole(top: Section, name: str, variant: str) -> Base:
    """Build a Base from the parsed top-level section, into which the variant's values are already merged."""
    sensors = read_sensors(top)
    footprint = _outline(top, "footprint")
    base = Base(
        name=name,
        variant=variant,
        summary=top.text("summary"),
        footprint=footprint,
        height=top.number("height", minimum=0.01),
        ground_clearance=top.number("ground_clearance", minimum=0.001),
        mass=top.number("mass", minimum=0.01),
        wheels=_wheels(top.section("wheels")),
        casters=tuple(_caster(item) for item in top.sections("casters")),
        limits=_limits(top.section("limits")),
        odometry=_odometry(top.section("odometry")),
        driver=_driver("base", top, "driver") if top.has("driver") else None,
        drivers=tuple(_drivers(part, sensors)) if (part := top.optional_section("drivers")) else (),
        body=_body(top, footprint) if top.has("body") else (),
    )
    if base.limits.sideways and base.driver and base.driver.protocol:
        top.fail(
            "driver",
            f"driver: {base.driver.protocol} in {top.name} drives two wheels, expected none of this project's with "
            "lateral_velocity",
            "leave out lateral_velocity, or name the driver of your mecanum or omni base",
        )
    top.finish()
    return replace(base, **sensors)  # type: ignore[arg-type]  # SENSORS pairs each key with its kind


def _outline(top: Section, key: str) -> tuple[Point, ...]:
    points = top.points(key, minimum=3)
    if measure_area(points) <= 0.0:
        top.fail(
            key,
            f"{key} in {top.name} goes round clockwise (or encloses nothing), expected counter-clockwise",
            "turn the list of points round",
        )
    crossing = find_crossing(points)
    if crossing:
        first, second = crossing
        edges = f"the edges from point {first} and point {second}"
        top.fail(key, f"{key} in {top.name} crosses itself: {edges}, expected an outline")
    return points


def _body(top: Section, footprint: tuple[Point, ...]) -> tuple[Point, ...]:
    body = _outline(top, "body")
    for x, y in body:
        if not is_inside((x, y), footprint, _TOLERANCE):
            top.fail("body", f"body in {top.name}: [{x:g}, {y:g}] is outside the footprint, expected all of it inside")
    return body


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


def _limits(part: Section) -> MotionLimits:
    acceleration = part.number("acceleration", minimum=0.01)
    angular_acceleration = part.number("angular_acceleration", minimum=0.01)
    limits = MotionLimits(
        velocity=part.number("velocity", minimum=0.01),
        angular_velocity=part.number("angular_velocity", minimum=0.01),
        acceleration=acceleration,
        angular_acceleration=angular_acceleration,
        deceleration=part.number("deceleration", acceleration, minimum=acceleration),
        angular_deceleration=part.number("angular_deceleration", angular_acceleration, minimum=angular_acceleration),
        command_age=part.number("command_age", minimum=0.02, maximum=1.0),
        lag=part.number("lag", 0.11, minimum=0.0, maximum=0.2),
        lateral_velocity=part.number("lateral_velocity", 0.0, minimum=0.0),
    )
    part.finish()
    return limits


def _odometry(part: Section) -> OdometryErrors:
    odometry = OdometryErrors(
        rate=part.number("rate", minimum=1.0),
        ticks_per_turn=part.integer("ticks_per_turn", minimum=1),
        wheel_noise=part.number("wheel_noise", minimum=0.0),
        radius_error=part.number("radius_error", minimum=0.0),
        separation_error=part.number("separation_error", minimum=0.0),
    )
    part.finish()
    return odometry


def _drivers(part: Section, sensors: Mapping[str, Sensor]) -> Iterator[UpstreamDriver]:
    there = [name for name in sensors if name != "battery"]
    choice = ", ".join(there) or "(it has none)"
    for name in part.keys:
        if name not in there:
            part.fail(
                name,
                f"{name} in {part.name} is no sensor of this base, expected one of {choice}",
                "the driver of the base itself stands in `driver`",
            )
        yield _driver(name, part, name)


def _driver(name: str, parent: Section, key: str) -> UpstreamDriver:
    """Read a driver: one of this project by its name, with an optional device, or an upstream driver."""
    if parent.is_text(key):
        return _own_driver(name, parent.text(key, choices=_names_of(name)), "", 0)
    part = parent.section(key)
    if part.has("protocol"):
        protocol = part.text("protocol", choices=_names_of(name))
        device = _word(part, "device", _OWN_DEVICE, "a device file, as /dev/ttyAMA0, or tcp://HOST:PORT", "")
        baud = part.integer("baud", 0, minimum=0)
        wiring = _wiring(wires) if name == "base" and (wires := part.optional_section("wiring")) else Wiring()
        part.finish()
        return replace(_own_driver(name, protocol, device, baud), wiring=wiring)
    return _upstream_driver(name, part)


def _wiring(part: Section) -> Wiring:
    wiring = Wiring(**{name: part.boolean(name, False) for name in WIRING_NAMES})
    part.finish()
    return wiring


def _names_of(part: str) -> list[str]:
    sensor = "" if part == "base" else part
    return [name for name, driver in OWN_DRIVERS.items() if driver.sensor == sensor] or ["(there is none)"]


def _own_driver(name: str, protocol: str, device: str, baud: int) -> UpstreamDriver:
    own = OWN_DRIVERS[protocol]
    return UpstreamDriver(
        part=name,
        node=own.node,
        package="ubiquity_launches",
        executable=own.executable,
        device=device or own.device,
        baud=baud or own.baud,
        install="it is part of this package",
        hardware="" if device else own.hardware,
        protocol=protocol,
    )


def _upstream_driver(name: str, part: Section) -> UpstreamDriver:
    driver = UpstreamDriver(
        part=name,
        node=_word(part, "node", r"n_[a-z0-9_]+", "the name of a launch directory, as n_motor_node", ""),
        package=_word(part, "package", r"[a-z][a-z0-9_]*", "the name of a ROS package"),
        executable=_word(part, "executable", r"[\w.-]+", "the name of an executable"),
        device=_word(part, "device", r"/dev/[\w./:-]+", "a device file, as /dev/ttyAMA0", ""),
        baud=part.integer("baud", 0, minimum=0),
        install=part.text("install"),
        hardware=part.text("hardware", ""),
    )
    if driver.hardware and not find_rows(driver.hardware):
        ids = sorted({row.id for row in load_known()})
        near = did_you_mean(driver.hardware, ids)
        part.fail(
            "hardware",
            f"hardware: {driver.hardware!r} in {part.name} is no known device, expected one of {', '.join(ids)}",
            f"did you mean {near!r}?" if near else "leave it out for a device that the table does not have",
        )
    if not driver.install.strip() or "\n" in driver.install.strip():
        part.fail("install", f"install: {driver.install!r} in {part.name}, expected one line on how to get the package")
    part.finish()
    return driver


def _word(part: Section, key: str, pattern: str, expected: str, default: str | None = None) -> str:
    value = part.text(key) if default is None else part.text(key, default)
    if value != default and not re.fullmatch(pattern, value):
        part.fail(key, f"{key}: {value!r} in {part.name}, expected {expected}")
    return value
