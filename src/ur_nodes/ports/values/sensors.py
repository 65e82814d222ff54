"""Scans, sonars, inertia, batteries, pictures, and the calibration of cameras."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Quaternion


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


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """One turn of a lidar: `ranges` (n,) float32 in m; beam i points to `angle_min` + i `angle_increment` (rad).

    REP 117: +inf means nothing within `range_max`, -inf too close to measure, NaN no measurement.
    """

    stamp: int
    frame: str
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32] = field(default_factory=lambda: np.zeros(0, np.float32))
    scan_time: float = 0.0
    angle_max: float | None = None
    """The angle of the last beam as its driver says it; None: from the others."""
    time_increment: float = 0.0
    """s from one beam to the next."""


@dataclass(frozen=True, slots=True)
class Range:
    """One measurement of a sonar or an infrared sensor: m, rad; +inf: nothing in reach (REP 117)."""

    stamp: int
    frame: str
    range: float
    field_of_view: float
    range_min: float
    range_max: float
    infrared: bool = False


@dataclass(frozen=True, slots=True)
class Imu:
    """Orientation (x, y, z, w), turning in rad/s, force in m/s^2, each of x, y, z; variances of each, of all axes."""

    stamp: int
    frame: str
    orientation: Quaternion
    turning: tuple[float, float, float]
    force: tuple[float, float, float]
    orientation_variance: float = 0.0
    turning_variance: float = 0.0
    force_variance: float = 0.0


@dataclass(frozen=True, slots=True)
class Battery:
    """V, A (negative: discharging), Ah; `fraction` 0 to 1; NaN where it is not measured."""

    stamp: int
    voltage: float
    current: float
    charge: float
    capacity: float
    fraction: float
    charging: bool = False
    technology: str = ""
    """lifepo4, lithium-ion, lithium-polymer, nicd, nimh, or '' for any other."""
