"""An inertial measurement unit: turning rates and specific force from how a body moves.

Axes and signs after REP 145: at rest, and level, the accelerometer reads +g along z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ur.robot.base import Imu
from ur_nodes.simulator.model import GRAVITY
from ur_nodes.simulator.scenery import rotation_axes

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Motion:
    """How a body moves at an instant.

    `rotation` is body to world, shape (3, 3); `velocity` that of the body's origin in the world, m/s; `turning` the
    angular velocity in the body, rad/s.
    """

    rotation: Floats
    velocity: Floats
    turning: Floats


@dataclass(frozen=True, slots=True)
class Reading:
    """What the unit says, in its own axes: quaternion x, y, z, w (unit to world), rad/s, m/s^2."""

    orientation: tuple[float, float, float, float]
    turning: tuple[float, float, float]
    force: tuple[float, float, float]


class InertialUnit:
    """One unit. Like a real one it integrates: a reading is the mean since the one before."""

    def __init__(self, imu: Imu) -> None:
        self._imu = imu
        self._place = np.array(imu.pose[:3], np.float64)
        self._mount = np.array(rotation_axes(imu.pose[3:])).T  # unit to body
        self._before: tuple[Motion, float] | None = None
        self._force = np.array([0.0, 0.0, GRAVITY])
        self._turning = np.zeros(3)
        self._rotation = self._mount

    def forget(self) -> None:
        """The body was moved by hand: do not take that for an acceleration."""
        self._before = None

    def sample(self, motion: Motion, time: float) -> None:
        """Take the body's motion at a time (s); called at the unit's rate."""
        before, then = self._before or (motion, time)
        if time > then:
            self._force = self._mount.T @ specific_force(before, motion, self._place, time - then)
        else:
            self._force = (motion.rotation @ self._mount).T @ np.array([0.0, 0.0, GRAVITY])
        self._turning = self._mount.T @ ((before.turning + motion.turning) / 2.0)
        self._rotation = motion.rotation @ self._mount
        self._before = motion, time

    def read(self, noise: Floats) -> Reading:
        """The last sample, with `noise` (standard normal, shape (6,): gyro, accelerometer) scaled to the unit's."""
        gx, gy, gz = (self._turning + self._imu.gyro_noise * noise[:3]).tolist()
        ax, ay, az = (self._force + self._imu.accel_noise * noise[3:]).tolist()
        return Reading(quaternion(self._rotation), (gx, gy, gz), (ax, ay, az))


def specific_force(before: Motion, after: Motion, place: Floats, period: float) -> Floats:
    """The mean force per mass (m/s^2, in the body's axes) at `place` (m, in the body) between two instants.

    It is what an accelerometer there feels: its acceleration, less that of free fall.
    """
    acceleration = (_velocity_at(after, place) - _velocity_at(before, place)) / period
    felt = acceleration + np.array([0.0, 0.0, GRAVITY])
    force: Floats = (before.rotation + after.rotation).T @ felt / 2.0
    return force


def quaternion(rotation: Floats) -> tuple[float, float, float, float]:
    """x, y, z, w of a rotation matrix, with w >= 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat().tolist()
    return (x, y, z, w) if w >= 0.0 else (-x, -y, -z, -w)


def _velocity_at(motion: Motion, place: Floats) -> Floats:
    velocity: Floats = motion.velocity + motion.rotation @ np.cross(motion.turning, place)
    return velocity
