"""An inertial measurement unit: turning rates and specific force from how a body moves.

Axes and signs after REP 145: at rest, and level, the accelerometer reads +g along z.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ur.robot.base import ImuErrors
from ur_nodes.geometry.pose import Quaternion, multiply, rotate
from ur_nodes.geometry.rigid import from_angles, to_quaternion
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Imu as Message
from ur_nodes.simulator.mujoco_model import GRAVITY
from ur_nodes.simulator.physics import BodyMotion
from ur_nodes.simulator.sensors.sense import Noise, Send, Sense, Site

Floats = npt.NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class ImuReading:
    """A reading of the unit, in its own axes: quaternion x, y, z, w (unit to world), rad/s, m/s^2."""

    orientation: tuple[float, float, float, float]
    turning: tuple[float, float, float]
    force: tuple[float, float, float]


_ORIENTATION_VARIANCE = 1e-6  # rad^2
_STILL = BodyMotion((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class InertialUnit:
    """One unit. Like a real one it integrates: a reading is the mean since the one before."""

    def __init__(self, imu: ImuErrors) -> None:
        self._imu = imu
        self._place = imu.pose[0], imu.pose[1], imu.pose[2]
        self._mount = to_quaternion(from_angles(imu.pose[:3], imu.pose[3:]))  # unit to body
        self._span: tuple[tuple[BodyMotion, float], tuple[BodyMotion, float]] | None = None

    def forget(self) -> None:
        """The body was moved by hand: do not take that for an acceleration."""
        self._span = None

    def sample(self, motion: BodyMotion, time: float) -> None:
        """Take the body's motion at a time (s); called at the unit's rate."""
        last = (motion, time)
        self._span = (self._span[1] if self._span else last, last)

    def read(self, noise: Floats) -> ImuReading:
        """The last sample, with `noise` (standard normal, shape (6,): gyro, accelerometer) scaled to the unit's.

        Before the first sample the unit is at rest in a level body.
        """
        still = (_STILL, 0.0)
        (before, then), (after, now) = self._span or (still, still)
        period = now - then if now > then else math.inf
        ax, ay, az = _turn_back(self._mount, specific_force(before, after, self._place, period))
        gx, gy, gz = _turn_back(self._mount, _mean(before.turning, after.turning))
        gyro, accel, (a, b, c, d, e, f) = self._imu.gyro_noise, self._imu.accel_noise, noise.tolist()
        turning = gx + gyro * a, gy + gyro * b, gz + gyro * c
        force = ax + accel * d, ay + accel * e, az + accel * f
        return ImuReading(with_positive_w(multiply(after.attitude, self._mount)), turning, force)


def specific_force(before: BodyMotion, after: BodyMotion, point: Vector, period: float) -> Vector:
    """The mean force per mass (m/s^2, in the body's axes) at `point` (m, in the body) between two instants.

    It is what an accelerometer there feels: its acceleration, less that of free fall.
    """
    (x, y, z), (a, b, c) = _velocity_at(after, point), _velocity_at(before, point)
    felt = (x - a) / period, (y - b) / period, (z - c) / period + GRAVITY
    return _mean(_turn_back(before.attitude, felt), _turn_back(after.attitude, felt))


def with_positive_w(rotation: Quaternion) -> Quaternion:
    """Return the same rotation with w >= 0."""
    x, y, z, w = rotation
    return (x, y, z, w) if w >= 0.0 else (-x, -y, -z, -w)


def _velocity_at(motion: BodyMotion, point: Vector) -> Vector:
    (u, v, w), (a, b, c), (x, y, z) = motion.velocity, motion.turning, point
    x, y, z = rotate(motion.attitude, (b * z - c * y, c * x - a * z, a * y - b * x))
    return u + x, v + y, w + z


def _mean(one: Vector, other: Vector) -> Vector:
    return (one[0] + other[0]) / 2.0, (one[1] + other[1]) / 2.0, (one[2] + other[2]) / 2.0


def _turn_back(rotation: Quaternion, vector: Vector) -> Vector:
    """Turn a vector by the inverse of a rotation."""
    x, y, z, w = rotation
    return rotate((-x, -y, -z, w), vector)


class ImuSense(Sense):
    """The inertial unit of one robot."""

    def __init__(self, imu: ImuErrors, site: Site) -> None:
        self._imu, self._site, self.rate = imu, site, imu.rate
        self._noise = Noise(site.key)
        self.begin()

    def begin(self) -> None:
        """It has been at rest."""
        self._unit = InertialUnit(self._imu)
        self._count = 0
        self.sample(0.0)

    def sample(self, time: float) -> None:
        """Take the motion of the robot."""
        self._unit.sample(self._site.physics.motion(self._site.robot), time)
        self._count += 1

    def forget_motion(self) -> None:
        """Do not take the new place for an acceleration."""
        self._unit.forget()

    def read(self) -> ImuReading:
        """Return the newest reading."""
        return self._unit.read(self._noise.draw(self._count, 6))

    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:
        """Open its topic."""
        publisher = node.publish(prefix + self._imu.topic, Message, quality)
        variances = _ORIENTATION_VARIANCE, self._imu.gyro_noise**2, self._imu.accel_noise**2

        def send(_time: float, stamp: int) -> None:
            if publisher.subscribers():
                reading = self.read()
                measured = reading.orientation, reading.turning, reading.force
                publisher.send(Message(stamp, prefix + self._imu.frame, *measured, *variances))

        return send


SENSE = ImuSense
