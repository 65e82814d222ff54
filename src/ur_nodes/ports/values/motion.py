"""Velocities, odometry, joints and joysticks."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, Quaternion
from ur_nodes.ports.values.basics import NO_MATRIX


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
    """A velocity with the time and the frame that its sender gives."""

    stamp: int
    frame: str
    twist: Twist


@dataclass(frozen=True, slots=True, eq=False)
class Odometry:
    """A base's estimate of its pose in `frame`, and of the velocity of `child`.

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
    """Odometry of a driver, not checked yet: m, m/s, rad/s."""

    stamp: int
    x: float
    y: float
    rotation: Quaternion
    forward: float
    turn: float


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
