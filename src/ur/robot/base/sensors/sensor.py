"""A sensor of a base: its section of the base file, its topics, frames, URDF and description.

A `pose` is x, y, z, roll, pitch, yaw in `base_footprint`. A `topic` is relative to the robot's namespace.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import ClassVar

from ur.source.section import Section

BODY_FRAMES = ("base_footprint", "base_link", "left_wheel", "right_wheel")


class Sensor(ABC):
    """One sensor of a base, or all of its sensors of one kind."""

    __slots__ = ()
    title: ClassVar[str]
    """Its name in tables."""
    article: ClassVar[str] = ""
    """Before its key in sentences: `a` lidar."""
    example: ClassVar[str]
    """Its section of a base file, for docs/how-to/describe-a-base.md."""

    @classmethod
    @abstractmethod
    def read(cls, part: Section, frames: FrameOwners) -> Sensor:
        """Read the sensor's section of a base file. Raises UserError with file, line and column."""

    @abstractmethod
    def topics(self) -> Mapping[str, str]:
        """The topics that the sensor publishes, with their types."""

    @abstractmethod
    def describe(self) -> str:
        """The sensor's properties in one line of Markdown."""

    def frames(self) -> tuple[str, ...]:
        """The frame_ids of the sensor's messages."""
        return ()

    def urdf(self, axle: float) -> Iterator[str]:  # noqa: ARG002 - for those that have frames
        """Yield the URDF links and joints of the sensor; `axle` is the height of `base_link` above the ground, m."""
        yield from ()


class FrameOwners:
    """Registry of the frames of a base, each with the sensor that owns it."""

    def __init__(self) -> None:
        self._owners = dict.fromkeys(BODY_FRAMES, "the body")

    def read(self, part: Section, default: str | None = None) -> str:
        """Read the key `frame` of a section and register the frame for that section."""
        frame = part.text("frame") if default is None else part.text("frame", default)
        self.claim(part, "frame", frame, part.name.rpartition(", ")[2])
        return frame

    def claim(self, part: Section, key: str, frame: str, owner: str) -> None:
        """Register the owner of a frame. Raises UserError at `key` if the frame is taken or is no valid name."""
        if not re.fullmatch(r"[A-Za-z]\w*", frame):
            part.fail(key, f"frame {frame!r} in {part.name}, expected a name of letters, digits and _")
        if re.fullmatch(r"caster_\d+", frame):
            part.fail(key, f"frame {frame!r} in {part.name} is the name of a caster, expected one of its own")
        if frame in self._owners:
            part.fail(key, f"frame {frame!r} in {part.name} is taken by {self._owners[frame]}, expected one of its own")
        self._owners[frame] = owner


def read_topic(part: Section, default: str) -> str:
    """Read the key `topic`, which is a ROS name."""
    topic = part.text("topic", default)
    if not re.fullmatch(r"[A-Za-z/][\w/]*", topic):
        part.fail("topic", f"topic: {topic!r} in {part.name}, expected a ROS name, as {default}")
    return topic


def read_places(part: Section, what: str, expected: str) -> Section:
    """Read the key `at`, a mapping of names to positions. Raises UserError if it is empty."""
    places = part.section("at")
    if not places.keys:
        part.fail("at", f"at: no {what} in {part.name}, expected {expected}")
    return places


def check_order(part: Section, low: str, least: float, high: str, most: float) -> None:
    """Raise UserError unless the value of `high` is greater than that of `low`."""
    if most <= least:
        part.fail(high, f"{high}: {most:g} in {part.name}, expected more than {low}")
