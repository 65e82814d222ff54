"""The values that nodes exchange. Frames and units are those of REP 103 and 105; stamps are ns of the nodes' clock.

Simple ones travel as Python's own: str, bool, float, int. Arrays are not to be written to: a value may be shared by
all who receive it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3, Quaternion

Level = Literal["debug", "info", "warn", "error"]
"""The level of a line of the log."""

NO_MATRIX: NDArray[np.float64] = np.zeros((0, 0))
"""Stands for a covariance that nobody gave."""


@dataclass(frozen=True, slots=True)
class Signal:
    """Says that something is to happen; carries nothing."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number in double precision; a `float` travels in single."""

    value: float


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that a node has logged; `node` is its full name."""

    node: str
    level: Level
    text: str


@dataclass(frozen=True, slots=True)
class Time:
    """A moment, ns."""

    stamp: int


@dataclass(frozen=True, slots=True)
class ClockTime:
    """The time of all nodes, ns, as their clock sends it."""

    stamp: int


@dataclass(frozen=True, slots=True)
class Twist:
    """A velocity in the frame of the base: ahead, to the left and up, m/s; turning to the left, roll, pitch, rad/s."""

    forward: float
    turn: float
    left: float = 0.0
    up: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0


@dataclass(frozen=True, slots=True)
class StampedTwist:
    """A velocity with the moment and the name that its sender gives it."""

    stamp: int
    frame: str
    twist: Twist


@dataclass(frozen=True, slots=True, eq=False)
class Odometry:
    """A base's belief of its pose in `frame`, and of the velocity of `child`.

    Covariances are (3, 3) of x, y, yaw (m, rad) and of forward, left, turn, or NO_MATRIX.
    """

    stamp: int
    frame: str
    child: str
    pose: Pose2
    twist: Twist
    pose_covariance: NDArray[np.float64] = field(default_factory=lambda: NO_MATRIX)
    twist_covariance: NDArray[np.float64] = field(default_factory=lambda: NO_MATRIX)


@dataclass(frozen=True, slots=True)
class DriverOdometry:
    """Odometry as a driver sends it, where it is not known yet whether it makes sense: m, m/s, rad/s."""

    stamp: int
    x: float
    y: float
    rotation: Quaternion
    forward: float
    turn: float


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


@dataclass(frozen=True, slots=True)
class Joints:
    """Angles (rad) and speeds (rad/s) of joints, by name; `speeds` may be empty."""

    stamp: int
    names: tuple[str, ...]
    angles: tuple[float, ...]
    speeds: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Joystick:
    """Positions of axes (-1 to 1) and buttons (0 or 1)."""

    stamp: int
    axes: tuple[float, ...]
    buttons: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class PlacedPose:
    """A pose in a frame."""

    stamp: int
    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class PoseEstimate:
    """A pose in a frame, and its covariance (3, 3) of x, y, yaw in m, rad."""

    stamp: int
    frame: str
    pose: Pose2
    covariance: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Poses (n, 3) float64 in a frame, m, m, rad, without an order."""

    stamp: int
    frame: str
    poses: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """Poses (n, 3) float64 in a frame, m, m, rad, in the order in which they are driven."""

    stamp: int
    frame: str
    poses: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A polygon: corners (n, 2) float64 in a frame, m."""

    stamp: int
    frame: str
    corners: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Map:
    """A grid in a frame."""

    stamp: int
    frame: str
    grid: Grid


@dataclass(frozen=True, slots=True)
class MapInfo:
    """The moment at which a map was made, its resolution (m) and size (cells), and the pose of its first cell."""

    stamp: int
    resolution: float
    width: int
    height: int
    origin: Pose2


@dataclass(frozen=True, slots=True, eq=False)
class MapUpdate:
    """Cells of a map that have changed: `values` int8 (rows, columns), the first at `row`, `column` of the map."""

    stamp: int
    frame: str
    row: int
    column: int
    values: NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Transform:
    """The pose of `child` in `parent`; `fixed`: it never changes."""

    stamp: int
    parent: str
    child: str
    pose: Pose3
    fixed: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture as its camera gives it: `encoding` and `step` (bytes a row) as in sensor_msgs/Image."""

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
    """A picture as a file; `format` is 'jpeg' or 'png', with what sensor_msgs/CompressedImage puts before it."""

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


Shape = Literal[
    "arrow", "cube", "sphere", "cylinder", "line_strip", "line_list", "cube_list", "sphere_list", "points", "text",
    "triangles",
]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Marker:
    """A shape to look at; `namespace` and `number` name it. `colour` is red, green, blue, opacity, 0 to 1.

    A cube has a `size` of x, y, z in m, a text the height of its letters in z, points (n, 3) in m their sides in x, y.
    `colours` (n, 4) are those of the points, where they differ.
    """

    namespace: str
    number: int
    shape: Shape
    pose: Pose3
    size: tuple[float, float, float]
    colour: tuple[float, float, float, float]
    text: str = ""
    points: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    colours: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 4)))


@dataclass(frozen=True, slots=True, eq=False)
class Markers:
    """Shapes in a frame, in place of all that were shown on the topic before."""

    stamp: int
    frame: str
    markers: tuple[Marker, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MarkerChange:
    """A change of the shapes that a topic shows: put a marker there, delete the one of its name, or clear all.

    A marker is shown for `lifetime` s; 0: until it is deleted.
    """

    stamp: int
    frame: str
    action: Literal["put", "delete", "clear"]
    marker: Marker
    lifetime: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class MarkerChanges:
    """Changes, one after the other."""

    changes: tuple[MarkerChange, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """Points in a frame: a structured array (n,) with the fields x, y, z in m and, where they have one, rgb.

    The numbers are of any type, not always finite; rgb is an unsigned 32-bit 0xRRGGBB. The memory is that of the
    message, with whatever else it holds of each point in between.
    """

    stamp: int
    frame: str
    points: NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Result:
    """A service's answer: whether it was done, a text for people, and `value`, what was asked for."""

    success: bool
    text: str = ""
    value: object = None
