"""Sonars."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, check_order, read_places, read_topic
from ur.robot.base.urdf_parts import link, mount, visual
from ur.source.section import Section


@dataclass(frozen=True, slots=True)
class Sonar:
    """One ultrasonic range finder, which looks along its x axis. `frame` is also its name."""

    frame: str
    pose: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Sonars(Sensor):
    """Range finders of one kind (sensor_msgs/Range) on one topic, distinguished by their frame_id.

    `rate` is the number of ranges per second of each sensor (they measure in turn), `field_of_view` the full angle of
    the cone (rad) and `noise` the standard deviation of a range (m). The range is that to the nearest surface in the
    cone; a range of `range_max` or more means that nothing was detected.
    """

    title: ClassVar[str] = "sonars"
    example: ClassVar[str] = """
sonars: # on one topic, told apart by frame; the rate is that of each
  {topic: sonars, rate: 4, field_of_view: 0.436, range_min: 0.02, range_max: 4.0, noise: 0.005,
   at: {sonar_0: [0.25, 0.08, 0.1, 0, 0, 0.3], sonar_1: [0.25, -0.08, 0.1, 0, 0, -0.3]}}
"""

    topic: str
    rate: float
    field_of_view: float
    range_min: float
    range_max: float
    noise: float
    at: tuple[Sonar, ...]

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> Sonars:
        """Read the section `sonars`."""
        places = read_places(part, "sonar", "frames with their poses")
        for name in places.keys:
            frames.claim(places, name, name, "sonars")
        sonars = cls(
            topic=read_topic(part, "sonars"),
            rate=part.number("rate", minimum=0.1, maximum=100.0),
            field_of_view=part.number("field_of_view", minimum=0.01, maximum=math.pi),
            range_min=part.number("range_min", minimum=0.0),
            range_max=part.number("range_max", minimum=0.01),
            noise=part.number("noise", minimum=0.0),
            at=tuple(Sonar(name, places.numbers(name, 6)) for name in places.keys),
        )
        check_order(part, "range_min", sonars.range_min, "range_max", sonars.range_max)
        return sonars

    def topics(self) -> Mapping[str, str]:
        """The topic that all sonars share."""
        return {self.topic: "sensor_msgs/Range"}

    def frames(self) -> tuple[str, ...]:
        """The frames of the sonars."""
        return tuple(sonar.frame for sonar in self.at)

    def urdf(self, axle: float) -> Iterator[str]:
        """A circuit board (HC-SR04) with a transmitter and a receiver per sonar; its front is the origin of ranges."""
        pin = '<cylinder radius="0.008" length="0.012"/>'
        for sonar in self.at:
            parts = [*visual('<box size="0.002 0.045 0.020"/>', "board", (-0.013, 0.0, 0.0))]
            for side in (0.013, -0.013):
                parts += visual(pin, "sensor", (-0.006, side, 0.0), (0.0, 1.570796, 0.0))
            yield from link(sonar.frame, parts)
            yield from mount(sonar.frame, sonar.pose, axle)

    def describe(self) -> str:
        """Topic, number of sonars, rate, field of view and maximum range, as Markdown."""
        cone = f"{math.degrees(self.field_of_view):.0f}°, {self.range_min:g} to {self.range_max:g} m"
        return f"`{self.topic}`: {len(self.at)}, each {self.rate:g} Hz, {cone}"
