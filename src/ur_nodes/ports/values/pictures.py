"""Pictures, and the calibration of their cameras."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Picture:
    """A raw picture of a camera: `encoding` and `step` (bytes a row) as in sensor_msgs/Image."""

    stamp: int
    frame: str
    width: int
    height: int
    encoding: str
    step: int
    data: bytes
    sequence: int = 0
    """The number that its sender counted it with, where the middleware has one."""


@dataclass(frozen=True, slots=True)
class PackedPicture:
    """A compressed picture; `format` is 'jpeg' or 'png', with the prefix of sensor_msgs/CompressedImage."""

    stamp: int
    frame: str
    format: str
    data: bytes
    sequence: int = 0
    """See Picture."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """A camera's size (px), and D, K (3, 3), R (3, 3) and P (3, 4), by rows, as in sensor_msgs/CameraInfo."""

    stamp: int
    frame: str
    width: int
    height: int
    model: str
    distortion: tuple[float, ...]
    matrix: tuple[float, ...]
    rectification: tuple[float, ...]
    projection: tuple[float, ...]
