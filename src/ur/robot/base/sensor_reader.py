"""The `sensors` of a base file."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ur.robot.base.sensors import Bumper, Bumpers, Camera, Cliff, Cliffs, ImuErrors, Lidar, Sonar, Sonars
from ur.source.section import Section

SENSORS = ("lidar", "raspicam", "sonars", "bumpers", "cliffs", "imu")
_BODY_FRAMES = ("base_footprint", "base_link", "left_wheel", "right_wheel")
_CENTRE = 0.01  # m


@dataclass(frozen=True, slots=True)
class Sensors:
    """The sensors of the section."""

    lidar: Lidar | None = None
    raspicam: Camera | None = None
    sonars: Sonars | None = None
    bumpers: Bumpers | None = None
    cliffs: Cliffs | None = None
    imu: ImuErrors | None = None


def read_sensors(part: Section | None) -> Sensors:
    """Read the section. Every frame has one owner."""
    if part is None:
        return Sensors()
    frames = dict.fromkeys(_BODY_FRAMES, "the body")
    sensors = Sensors(
        lidar=_lidar(own, frames) if (own := part.optional_section("lidar")) else None,
        raspicam=_camera(own, frames) if (own := part.optional_section("raspicam")) else None,
        sonars=_sonars(own, frames) if (own := part.optional_section("sonars")) else None,
        bumpers=_bumpers(own) if (own := part.optional_section("bumpers")) else None,
        cliffs=_cliffs(own, frames) if (own := part.optional_section("cliffs")) else None,
        imu=_imu(own, frames) if (own := part.optional_section("imu")) else None,
    )
    part.finish()
    return sensors


def read_topic(part: Section, default: str) -> str:
    """The key `topic`: a ROS name."""
    topic = part.text("topic", default)
    if not re.fullmatch(r"[A-Za-z/][\w/]*", topic):
        part.fail("topic", f"topic: {topic!r} in {part.name}, expected a ROS name, as {default}")
    return topic


def _lidar(part: Section, frames: dict[str, str]) -> Lidar:
    lidar = Lidar(
        frame=_frame(part, frames),
        topic=read_topic(part, "scan"),
        pose=part.numbers("pose", 6),
        angle_min=part.number("angle_min"),
        angle_max=part.number("angle_max"),
        samples=part.integer("samples", minimum=2),
        rate=part.number("rate", minimum=0.1),
        range_min=part.number("range_min", minimum=0.0),
        range_max=part.number("range_max", minimum=0.01),
        noise=part.number("noise", minimum=0.0),
    )
    _check_order(part, "angle_min", lidar.angle_min, "angle_max", lidar.angle_max)
    _check_order(part, "range_min", lidar.range_min, "range_max", lidar.range_max)
    part.finish()
    return lidar


def _camera(part: Section, frames: dict[str, str]) -> Camera:
    frame = _frame(part, frames, "raspicam")
    _claim(part, "frame", f"{frame}_body", frames, "raspicam")
    camera = Camera(
        frame=frame,
        name=part.text("name", "raspicam_node"),
        pose=part.numbers("pose", 6),
        width=part.integer("width", minimum=16),
        height=part.integer("height", minimum=16),
        field_of_view=part.number("field_of_view", minimum=0.1, maximum=2.6),
        rate=part.number("rate", minimum=0.1, maximum=200.0),
    )
    part.finish()
    return camera


def _sonars(part: Section, frames: dict[str, str]) -> Sonars:
    places = part.section("at")
    if not places.keys:
        part.fail("at", f"at: no sonar in {part.name}, expected frames with their poses")
    for name in places.keys:
        _claim(places, name, name, frames, "sonars")
    sonars = Sonars(
        topic=read_topic(part, "sonars"),
        rate=part.number("rate", minimum=0.1, maximum=100.0),
        field_of_view=part.number("field_of_view", minimum=0.01, maximum=math.pi),
        range_min=part.number("range_min", minimum=0.0),
        range_max=part.number("range_max", minimum=0.01),
        noise=part.number("noise", minimum=0.0),
        at=tuple(Sonar(name, places.numbers(name, 6)) for name in places.keys),
    )
    _check_order(part, "range_min", sonars.range_min, "range_max", sonars.range_max)
    part.finish()
    return sonars


def _bumpers(part: Section) -> Bumpers:
    places = part.section("at")
    if not places.keys:
        part.fail("at", f"at: no bumper in {part.name}, expected names with their sectors")
    bumpers = Bumpers(topic=read_topic(part, "bumper"), at=tuple(_bumper(places, name) for name in places.keys))
    part.finish()
    return bumpers


def _bumper(places: Section, name: str) -> Bumper:
    start, end = places.numbers(name, 2)
    turn = 2.0 * math.pi
    if not (abs(start) <= turn and start < end <= start + turn):
        places.fail(
            name,
            f"{name}: [{start:g}, {end:g}] in {places.name}, expected the angles from and to of a sector, "
            "counter-clockwise, in rad",
            "the second angle is greater than the first: a sector across the back is [2.8, 3.5]",
        )
    return Bumper(name, start, end)


def _cliffs(part: Section, frames: dict[str, str]) -> Cliffs:
    places = part.section("at")
    if not places.keys:
        part.fail("at", f"at: no cliff sensor in {part.name}, expected names with their positions")
    cliffs = Cliffs(
        topic=read_topic(part, "cliff"), at=tuple(Cliff(name, places.numbers(name, 3)) for name in places.keys)
    )
    for cliff in cliffs.at:
        _claim(places, cliff.name, cliff.frame, frames, "cliffs")
        x, y, z = cliff.position
        if math.hypot(x, y) < _CENTRE:
            places.fail(
                cliff.name,
                f"{cliff.name}: x {x:g}, y {y:g} in {places.name}, expected a position away from the centre",
                "the robot stops in the direction of the sensor",
            )
        if z < 0.0:
            places.fail(cliff.name, f"{cliff.name}: z {z:g} in {places.name}, expected a height above the floor")
    part.finish()
    return cliffs


def _imu(part: Section, frames: dict[str, str]) -> ImuErrors:
    imu = ImuErrors(
        frame=_frame(part, frames),
        topic=read_topic(part, "imu/data"),
        pose=part.numbers("pose", 6),
        rate=part.number("rate", minimum=0.1, maximum=1000.0),
        gyro_noise=part.number("gyro_noise", minimum=0.0),
        accel_noise=part.number("accel_noise", minimum=0.0),
    )
    part.finish()
    return imu


def _frame(part: Section, frames: dict[str, str], default: str | None = None) -> str:
    frame = part.text("frame") if default is None else part.text("frame", default)
    _claim(part, "frame", frame, frames, part.name.rpartition(", ")[2])
    return frame


def _claim(part: Section, key: str, frame: str, frames: dict[str, str], owner: str) -> None:
    if not re.fullmatch(r"[A-Za-z]\w*", frame):
        part.fail(key, f"frame {frame!r} in {part.name}, expected a name of letters, digits and _")
    if re.fullmatch(r"caster_\d+", frame):
        part.fail(key, f"frame {frame!r} in {part.name} is the name of a caster, expected one of its own")
    if frame in frames:
        part.fail(key, f"frame {frame!r} in {part.name} is taken by {frames[frame]}, expected one of its own")
    frames[frame] = owner


def _check_order(part: Section, low: str, least: float, high: str, most: float) -> None:
    if most <= least:
        part.fail(high, f"{high}: {most:g} in {part.name}, expected more than {low}")
