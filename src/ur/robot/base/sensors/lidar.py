"""A planar lidar."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, check_order, read_topic
from ur.robot.base.urdf_parts import link, mount, visual
from ur.source.section import Section


@dataclass(frozen=True, slots=True)
class Lidar(Sensor):
    """A planar lidar (sensor_msgs/LaserScan).

    `rate` is in scans per second; `noise` is the standard deviation of a range, m. The lidar is turned on its robot by
    `askew` (rad) beyond its `pose`, which its scans allow for: their angles begin that much later.
    """

    title: ClassVar[str] = "lidar"
    article: ClassVar[str] = "a"
    example: ClassVar[str] = """
lidar: {frame: laser, topic: scan, pose: [0.1, 0, 0.3, 0, 0, 0], angle_min: -3.14159, angle_max: 3.12414, samples: 360,
        rate: 10, range_min: 0.1, range_max: 12.0, noise: 0.01}
"""

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
    askew: float = 0.0

    @property
    def upright(self) -> float:
        """1.0, or -1.0 where it hangs upside down, and a robot that turns left turns right in its frame."""
        return math.copysign(1.0, math.cos(self.pose[3]) * math.cos(self.pose[4]))

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> Lidar:
        """Read the section `lidar`."""
        lidar = cls(
            frame=frames.read(part),
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
        check_order(part, "angle_min", lidar.angle_min, "angle_max", lidar.angle_max)
        check_order(part, "range_min", lidar.range_min, "range_max", lidar.range_max)
        return lidar

    def topics(self) -> Mapping[str, str]:
        """The topic of the scans."""
        return {self.topic: "sensor_msgs/LaserScan"}

    def frames(self) -> tuple[str, ...]:
        """The frame of the lidar."""
        return (self.frame,)

    def urdf(self, axle: float) -> Iterator[str]:
        """A cylinder for the lidar's body."""
        yield from link(self.frame, visual('<cylinder radius="0.035" length="0.04"/>', "sensor"))
        yield from mount(self.frame, self.pose, axle)

    def describe(self) -> str:
        """Topic, number of beams, rate and maximum range, as Markdown."""
        turn = math.degrees(self.angle_max - self.angle_min) * self.samples / (self.samples - 1)
        reach = f"{self.range_min:g} to {self.range_max:g} m"
        return f"`{self.topic}`: {self.samples} beams over {turn:.0f}°, {self.rate:g} Hz, {reach}"
