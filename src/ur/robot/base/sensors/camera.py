"""A camera."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor
from ur.robot.base.urdf_parts import joint, link, mount, visual
from ur.source.section import Section


@dataclass(frozen=True, slots=True)
class Camera(Sensor):
    """A camera without distortion; `pose` is that of its body, which looks along its x axis.

    `frame` is the optical frame (REP 103: z forward, x right, y down); `name` is the node, and thus the namespace of
    the topics. `width` and `height` are in pixels, `field_of_view` is the horizontal angle (rad), `rate` is in images
    per second.
    """

    title: ClassVar[str] = "camera"
    article: ClassVar[str] = "a"
    example: ClassVar[str] = """
raspicam: {frame: raspicam, pose: [0.26, 0, 0.2, 0, 0, 0], width: 640, height: 480, field_of_view: 1.0856, rate: 15}
"""

    frame: str
    name: str
    pose: tuple[float, ...]
    width: int
    height: int
    field_of_view: float
    rate: float

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> Camera:
        """Read the section `camera`."""
        frame = frames.read(part, "raspicam")
        frames.claim(part, "frame", f"{frame}_body", "raspicam")
        return cls(
            frame=frame,
            name=part.text("name", "raspicam_node"),
            pose=part.numbers("pose", 6),
            width=part.integer("width", minimum=16),
            height=part.integer("height", minimum=16),
            field_of_view=part.number("field_of_view", minimum=0.1, maximum=2.6),
            rate=part.number("rate", minimum=0.1, maximum=200.0),
        )

    @property
    def focal_length(self) -> float:
        """The focal length of the pinhole model in pixels, equal along both axes."""
        return self.width / 2.0 / math.tan(self.field_of_view / 2.0)

    def topics(self) -> Mapping[str, str]:
        """The topics of the raw image, the compressed image and the camera info."""
        return {
            f"{self.name}/image_raw": "sensor_msgs/Image",
            f"{self.name}/image/compressed": "sensor_msgs/CompressedImage",
            f"{self.name}/camera_info": "sensor_msgs/CameraInfo",
        }

    def frames(self) -> tuple[str, ...]:
        """The optical frame."""
        return (self.frame,)

    def urdf(self, axle: float) -> Iterator[str]:
        """The camera body, which looks along x, and its optical frame (REP 103)."""
        body = f"{self.frame}_body"
        lens = '<cylinder radius="0.004" length="0.006"/>'
        parts = [
            *visual('<box size="0.004 0.025 0.024"/>', "board", (-0.002, 0.0, 0.0)),
            *visual(lens, "sensor", (0.003, 0.0, 0.0), (0.0, 1.570796, 0.0)),
        ]
        yield from link(body, parts)
        yield from mount(body, self.pose, axle)
        yield f'  <link name="{self.frame}"/>'
        yield from joint(self.frame, (0.0, 0.0, 0.0), parent=body, angles=(-1.570796, 0.0, -1.570796))

    def describe(self) -> str:
        """Node, image size, field of view and direction, as Markdown."""
        looks = "up" if math.sin(self.pose[4]) < -0.7 else "ahead"
        size = f"{self.width} x {self.height}, {self.rate:g} Hz"
        return f"`{self.name}`: {size}, {math.degrees(self.field_of_view):.0f}° wide, looks {looks}"
