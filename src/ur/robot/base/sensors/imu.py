"""An inertial measurement unit (IMU)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, read_topic
from ur.robot.base.urdf_parts import link, mount, visual
from ur.source.section import Section


@dataclass(frozen=True, slots=True)
class ImuErrors(Sensor):
    """An IMU (sensor_msgs/Imu) with its noise: standard deviations per reading in rad/s and m/s^2; `rate` in Hz."""

    title: ClassVar[str] = "inertial sensor"
    article: ClassVar[str] = "an"
    example: ClassVar[str] = """
imu: {frame: imu, topic: imu/data, pose: [0, 0, 0.12, 0, 0, 0], rate: 50, gyro_noise: 0.001, accel_noise: 0.03}
"""

    frame: str
    topic: str
    pose: tuple[float, ...]
    rate: float
    gyro_noise: float
    accel_noise: float

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> ImuErrors:
        """Read the section `imu`."""
        return cls(
            frame=frames.read(part),
            topic=read_topic(part, "imu/data"),
            pose=part.numbers("pose", 6),
            rate=part.number("rate", minimum=0.1, maximum=1000.0),
            gyro_noise=part.number("gyro_noise", minimum=0.0),
            accel_noise=part.number("accel_noise", minimum=0.0),
        )

    def topics(self) -> Mapping[str, str]:
        """The topic of the readings."""
        return {self.topic: "sensor_msgs/Imu"}

    def frames(self) -> tuple[str, ...]:
        """The frame of the IMU."""
        return (self.frame,)

    def urdf(self, axle: float) -> Iterator[str]:
        """A small circuit board."""
        yield from link(self.frame, visual('<box size="0.020 0.016 0.003"/>', "board"))
        yield from mount(self.frame, self.pose, axle)

    def describe(self) -> str:
        """Topic and rate, as Markdown."""
        return f"`{self.topic}`: {self.rate:g} Hz"
