"""The sensors that a base may have.

A `pose` is x, y, z, roll, pitch, yaw in `base_footprint`. A `topic` is relative to the robot's namespace.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Lidar:
    """A planar lidar (sensor_msgs/LaserScan), `rate` scans a second. `noise` is the standard deviation of a range."""

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


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera without distortion. Its body has the pose: it looks along its x axis.

    `frame` is the optical frame (REP 103: z forward, x right, y down); `name` is the node, and so the namespace of the
    topics. `width` and `height` are in pixels, `field_of_view` is the horizontal angle, `rate` is in images a second.
    """

    frame: str
    name: str
    pose: tuple[float, ...]
    width: int
    height: int
    field_of_view: float
    rate: float

    @property
    def focal_length(self) -> float:
        """Of the pinhole, in pixels, along both axes."""
        return self.width / 2.0 / math.tan(self.field_of_view / 2.0)


@dataclass(frozen=True, slots=True)
class Sonar:
    """One ultrasonic ranger, which looks along its x axis. `frame` is its name, too."""

    frame: str
    pose: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Sonars:
    """Rangers of one kind (sensor_msgs/Range): all on one topic, told apart by frame_id.

    `rate` is how many ranges each of them gives a second (they take turns), `field_of_view` the full angle of the cone
    and `noise` the standard deviation of a range. The range is that to the nearest surface in the cone; `range_max`
    and beyond means that nothing was heard.
    """

    topic: str
    rate: float
    field_of_view: float
    range_min: float
    range_max: float
    noise: float
    at: tuple[Sonar, ...]


@dataclass(frozen=True, slots=True)
class Bumper:
    """A switch behind a part of the outline: where the direction from `base_footprint` lies in `start` to `end`.

    The angles are counter-clockwise from the x axis; `start` is in -2 pi to 2 pi and less than `end`, by 2 pi at most.
    """

    name: str
    start: float
    end: float

    def covers(self, x: float, y: float) -> bool:
        """Return whether a touch at a point (in `base_footprint`) closes this switch."""
        turn = 2.0 * math.pi
        return (math.atan2(y, x) - self.start) % turn <= self.end - self.start


@dataclass(frozen=True, slots=True)
class Bumpers:
    """The contact switches, in the order of the file."""

    topic: str
    at: tuple[Bumper, ...]


@dataclass(frozen=True, slots=True)
class Cliff:
    """A sensor that looks straight down from `position` (x, y, z in `base_footprint`)."""

    name: str
    position: tuple[float, ...]

    @property
    def frame(self) -> str:
        """Its x axis points down."""
        return f"cliff_{self.name}"

    @property
    def direction(self) -> float:
        """The angle of the sensor as seen from `base_footprint`, rad."""
        return math.atan2(self.position[1], self.position[0])


@dataclass(frozen=True, slots=True)
class Cliffs:
    """The sensors of a floor that ends (std_msgs/Bool, a topic each), in the order of the file."""

    topic: str
    at: tuple[Cliff, ...]


@dataclass(frozen=True, slots=True)
class ImuErrors:
    """An inertial sensor (sensor_msgs/Imu): standard deviations per reading, rad/s and m/s^2; `rate` a second."""

    frame: str
    topic: str
    pose: tuple[float, ...]
    rate: float
    gyro_noise: float
    accel_noise: float
