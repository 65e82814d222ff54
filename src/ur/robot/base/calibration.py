"""The differences of a robot from its base file: `calibration` in its robot file, `errors` of a simulated robot."""

import math
import re
from dataclasses import dataclass, replace

from ur.robot.base.properties import Base
from ur.source.file import SourceFile
from ur.source.section import Section, parse_section

_MOST_YAW = math.pi
_FACTORS = {"minimum": 0.5, "maximum": 2.0}


@dataclass(frozen=True, slots=True)
class Calibration:
    """The yaw (rad) of the lidar beyond that of the base file, and factors of the wheels' radius and separation."""

    lidar_yaw: float = 0.0
    wheel_radius: float = 1.0
    wheel_separation: float = 1.0

    def apply(self, base: Base) -> Base:
        """Return a base as this calibration has it."""
        radius, separation = base.wheels.radius * self.wheel_radius, base.wheels.separation * self.wheel_separation
        lidar = base.lidar and replace(base.lidar, askew=base.lidar.askew + self.lidar_yaw)
        return replace(base, wheels=replace(base.wheels, radius=radius, separation=separation), lidar=lidar)

    def then(self, found: "Calibration") -> "Calibration":
        """Return the calibration of a robot that used this one while the other was found."""
        yaw = math.remainder(self.lidar_yaw + found.lidar_yaw, math.tau)
        radius, separation = self.wheel_radius * found.wheel_radius, self.wheel_separation * found.wheel_separation
        return Calibration(yaw, radius, separation)

    def write(self) -> str:
        """Return the text that `read_calibration` reads."""
        return (
            f"{{lidar_yaw: {self.lidar_yaw:.4f}, wheel_radius: {self.wheel_radius:.4f}, "
            f"wheel_separation: {self.wheel_separation:.4f}}}"
        )


def read_calibration(part: Section) -> Calibration:
    """Read a calibration. Raises UserError."""
    found = Calibration(
        part.number("lidar_yaw", 0.0, minimum=-_MOST_YAW, maximum=_MOST_YAW),
        part.number("wheel_radius", 1.0, **_FACTORS),
        part.number("wheel_separation", 1.0, **_FACTORS),
    )
    part.finish()
    return found


def parse_calibration(text: str, place: str) -> Calibration:
    """Parse the text of a calibration; '' is that of a robot as its base file has it. Raises UserError: at `place`."""
    return read_calibration(parse_section(SourceFile(place, text), "a calibration")) if text else Calibration()


def write_calibration(text: str, calibration: Calibration) -> str:
    """Return the text of a robot file with another calibration; all other lines stay."""
    rest = re.sub(r"(?m)^calibration[ \t]*:.*\n?(?:[ \t]+\S.*\n?)*", "", text)
    return f"{rest.rstrip()}\ncalibration: {calibration.write()}\n"
