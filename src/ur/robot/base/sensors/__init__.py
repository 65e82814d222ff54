"""The sensors that a base may have: `Sensors` is their table, with a module for each beside it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import get_args, get_type_hints

from ur.robot.base.sensors.battery import BatteryProperties
from ur.robot.base.sensors.bumpers import Bumper, Bumpers
from ur.robot.base.sensors.camera import Camera
from ur.robot.base.sensors.cliffs import Cliff, Cliffs
from ur.robot.base.sensors.imu import ImuErrors
from ur.robot.base.sensors.lidar import Lidar
from ur.robot.base.sensors.sensor import FrameOwners, Sensor
from ur.robot.base.sensors.sonars import Sonar, Sonars
from ur.source.section import Section

__all__ = [
    "SENSORS",
    "BatteryProperties",
    "Bumper",
    "Bumpers",
    "Camera",
    "Cliff",
    "Cliffs",
    "ImuErrors",
    "Lidar",
    "Sensor",
    "Sensors",
    "Sonar",
    "Sonars",
    "read_sensors",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """The sensors of a base, by their keys in the section `sensors` of its file; `battery` is a top-level key."""

    lidar: Lidar | None = None
    raspicam: Camera | None = None
    sonars: Sonars | None = None
    bumpers: Bumpers | None = None
    cliffs: Cliffs | None = None
    imu: ImuErrors | None = None
    battery: BatteryProperties | None = None

    def list_sensors(self) -> Iterator[tuple[str, Sensor]]:
        """Yield the sensors that the base has, with their keys, in the order of the table."""
        for name in SENSORS:
            if (found := getattr(self, name)) is not None:
                yield name, found


SENSORS: Mapping[str, type[Sensor]] = {name: get_args(hint)[0] for name, hint in get_type_hints(Sensors).items()}
"""Every kind of sensor by its key."""
_AT_TOP = frozenset({"battery"})


def read_sensors(top: Section) -> dict[str, Sensor]:
    """Read the sensors of a base file, by key. Two sensors cannot have the same frame."""
    inner = top.optional_section("sensors")
    found: dict[str, Sensor] = {}
    frames = FrameOwners()
    for name, kind in SENSORS.items():
        outer = top if name in _AT_TOP else inner
        part = outer.optional_section(name) if outer is not None else None
        if part:
            found[name] = kind.read(part, frames)
            part.finish()
    if inner is not None:
        inner.finish()
    return found
