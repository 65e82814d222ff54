"""Cliff sensors, which detect that the floor ends."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, read_places, read_topic
from ur.robot.base.urdf_parts import link, mount, visual
from ur.source.section import Section

_CENTRE = 0.01  # m


@dataclass(frozen=True, slots=True)
class Cliff:
    """A cliff sensor that looks straight down from `position` (x, y, z in `base_footprint`)."""

    name: str
    position: tuple[float, ...]

    @property
    def frame(self) -> str:
        """The frame of the sensor, whose x axis points down."""
        return f"cliff_{self.name}"

    @property
    def direction(self) -> float:
        """The angle of the sensor as seen from `base_footprint`, rad."""
        return math.atan2(self.position[1], self.position[0])


@dataclass(frozen=True, slots=True)
class Cliffs(Sensor):
    """The cliff sensors (std_msgs/Bool, one topic per sensor), in the order of the file."""

    title: ClassVar[str] = "cliff sensors"
    example: ClassVar[str] = """
cliffs: # each looks straight down from x, y, z; its frame is cliff_<name>
  {topic: cliff, at: {left: [0.22, 0.12, 0.03], right: [0.22, -0.12, 0.03]}}
"""

    topic: str
    at: tuple[Cliff, ...]

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> Cliffs:
        """Read the section `cliffs`."""
        places = read_places(part, "cliff sensor", "names with their positions")
        cliffs = cls(read_topic(part, "cliff"), tuple(Cliff(name, places.numbers(name, 3)) for name in places.keys))
        for cliff in cliffs.at:
            frames.claim(places, cliff.name, cliff.frame, "cliffs")
            x, y, z = cliff.position
            if math.hypot(x, y) < _CENTRE:
                places.fail(
                    cliff.name,
                    f"{cliff.name}: x {x:g}, y {y:g} in {places.name}, expected a position away from the centre",
                    "the robot stops in the direction of the sensor",
                )
            if z < 0.0:
                places.fail(cliff.name, f"{cliff.name}: z {z:g} in {places.name}, expected a height above the floor")
        return cliffs

    def topics(self) -> Mapping[str, str]:
        """The topics of the cliff sensors."""
        return {f"{self.topic}/{cliff.name}": "std_msgs/Bool" for cliff in self.at}

    def frames(self) -> tuple[str, ...]:
        """The frames of the cliff sensors."""
        return tuple(cliff.frame for cliff in self.at)

    def urdf(self, axle: float) -> Iterator[str]:
        """A small window that faces down for each cliff sensor."""
        for cliff in self.at:
            yield from link(cliff.frame, visual('<box size="0.004 0.012 0.008"/>', "sensor", (-0.002, 0.0, 0.0)))
            yield from mount(cliff.frame, (*cliff.position, 0.0, 1.570796, 0.0), axle)

    def describe(self) -> str:
        """Topic and names of the cliff sensors, as Markdown."""
        return f"`{self.topic}`: {', '.join(cliff.name for cliff in self.at)}"
