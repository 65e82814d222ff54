"""Poses in the plane and in space, and their composition."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Quaternion = tuple[float, float, float, float]
"""x, y, z, w, of length 1."""

Angle = TypeVar("Angle", float, "NDArray[np.float64]")


class Pose2(NamedTuple):
    """A planar pose: m, m, rad."""

    x: float
    y: float
    yaw: float

    def compose(self, other: Pose2) -> Pose2:
        """Express `other`, given in this pose's frame, in this pose's parent frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2(
            self.x + c * other.x - s * other.y, self.y + s * other.x + c * other.y, wrap_angle(self.yaw + other.yaw)
        )

    def inverse(self) -> Pose2:
        """Express the parent frame's pose in this pose's frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2(-c * self.x - s * self.y, s * self.x - c * self.y, -self.yaw)

    def in_space(self) -> Pose3:
        """Convert to a pose in space, on the ground."""
        return Pose3(self.x, self.y, 0.0, *quaternion_of_yaw(self.yaw))

    def transform_points(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """Express points (..., 2) in m, given in this pose's frame, in this pose's parent frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        moved: NDArray[np.float64] = points @ ((c, s), (-s, c)) + (self.x, self.y)
        return moved


class Pose3(NamedTuple):
    """A pose in space: a position in m and a rotation as a unit quaternion x, y, z, w."""

    x: float
    y: float
    z: float
    qx: float
    qy: float
    qz: float
    qw: float

    @property
    def rotation(self) -> Quaternion:
        """Return the quaternion x, y, z, w."""
        return self.qx, self.qy, self.qz, self.qw

    def compose(self, other: Pose3) -> Pose3:
        """Express `other`, given in this pose's frame, in this pose's parent frame."""
        x, y, z = rotate(self.rotation, (other.x, other.y, other.z))
        return Pose3(self.x + x, self.y + y, self.z + z, *multiply(self.rotation, other.rotation))

    def inverse(self) -> Pose3:
        """Express the parent frame's pose in this pose's frame."""
        rotation = (-self.qx, -self.qy, -self.qz, self.qw)
        x, y, z = rotate(rotation, (-self.x, -self.y, -self.z))
        return Pose3(x, y, z, *rotation)

    def planar(self) -> Pose2:
        """Return the planar pose, without height, roll and pitch."""
        return Pose2(self.x, self.y, yaw_of_quaternion(*self.rotation))


def arc_end(distance: float, angle: float, left: float = 0.0) -> Pose2:
    """Return the pose after a way (m, negative is back) along an arc that turns by an angle (rad).

    `left` is the way to the left of the heading that is driven at the same time, m.
    """
    half = angle / 2.0
    share = math.sin(half) / half if abs(half) > 1e-6 else 1.0
    chord, c, s = distance * share, math.cos(half), math.sin(half)
    if not left:
        return Pose2(chord * c, chord * s, angle)
    return Pose2(chord * c - left * share * s, chord * s + left * share * c, angle)


def make_pose3(position: tuple[float, float, float], quaternion: Quaternion) -> Pose3:
    """Return a pose with a normalised quaternion; the all-zero one, sent by mistake, means no rotation."""
    length = math.sqrt(sum(part * part for part in quaternion))
    if length == 0.0:
        return Pose3(*position, 0.0, 0.0, 0.0, 1.0)
    qx, qy, qz, qw = quaternion
    return Pose3(*position, qx / length, qy / length, qz / length, qw / length)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation `b` followed by the rotation `a` (Hamilton product)."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(rotation: Quaternion, vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """Rotate a vector by a unit quaternion."""
    qx, qy, qz, qw = rotation
    x, y, z = vector
    tx, ty, tz = 2.0 * (qy * z - qz * y), 2.0 * (qz * x - qx * z), 2.0 * (qx * y - qy * x)
    return (x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx)


def interpolate(a: Pose3, b: Pose3, share: float) -> Pose3:
    """Return the pose at a `share` (0 to 1) from `a` to `b`, rotating through the smaller angle (slerp)."""
    dot = sum(p * q for p, q in zip(a.rotation, b.rotation, strict=True))
    sign = -1.0 if dot < 0.0 else 1.0
    angle = math.acos(min(1.0, abs(dot)))
    if angle < 1e-6:
        low, high = 1.0 - share, share
    else:
        low, high = (math.sin(part * angle) / math.sin(angle) for part in (1.0 - share, share))
    rotation = [low * p + sign * high * q for p, q in zip(a.rotation, b.rotation, strict=True)]
    x, y, z = ((1.0 - share) * p + share * q for p, q in zip(a[:3], b[:3], strict=True))
    return make_pose3((x, y, z), (rotation[0], rotation[1], rotation[2], rotation[3]))


def yaw_of_quaternion(x: float, y: float, z: float, w: float) -> float:
    """Return the rotation about z (rad); 0 for the all-zero quaternion."""
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def quaternion_of_yaw(yaw: float) -> Quaternion:
    """Return a rotation about z by an angle in rad."""
    return 0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)


def wrap_angle(angle: Angle) -> Angle:
    """Return the same direction, or directions (...), in (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)
