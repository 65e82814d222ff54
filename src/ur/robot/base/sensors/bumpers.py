"""Bumpers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, read_places, read_topic
from ur.source.section import Section


@dataclass(frozen=True, slots=True)
class Bumper:
    """A contact switch behind a part of the outline, between the directions `start` and `end` from `base_footprint`.

    The angles (rad) are counter-clockwise from the x axis; `start` is in -2 pi to 2 pi and less than `end`, by 2 pi at
    most.
    """

    name: str
    start: float
    end: float

    def covers(self, x: float, y: float) -> bool:
        """Return whether a contact at a point (in `base_footprint`) closes this switch."""
        turn = 2.0 * math.pi
        return (math.atan2(y, x) - self.start) % turn <= self.end - self.start


@dataclass(frozen=True, slots=True)
class Bumpers(Sensor):
    """The contact switches (std_msgs/Bool, one topic per switch), in the order of the file."""

    title: ClassVar[str] = "bumpers"
    example: ClassVar[str] = """
bumpers: # a part of the outline each: from one direction to another, counter-clockwise
  {topic: bumper, at: {left: [0.0, 1.2], right: [-1.2, 0.0]}}
"""

    topic: str
    at: tuple[Bumper, ...]

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> Bumpers:  # noqa: ARG003 - switches have no frames
        """Read the section `bumpers`."""
        places = read_places(part, "bumper", "names with their sectors")
        return cls(read_topic(part, "bumper"), tuple(_read_bumper(places, name) for name in places.keys))

    def topics(self) -> Mapping[str, str]:
        """The topics of the switches."""
        return {f"{self.topic}/{bumper.name}": "std_msgs/Bool" for bumper in self.at}

    def describe(self) -> str:
        """Topic and names of the switches, as Markdown."""
        return f"`{self.topic}`: {', '.join(bumper.name for bumper in self.at)}"


def _read_bumper(places: Section, name: str) -> Bumper:
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
