"""Rigid transforms in space as 4 x 4 matrices: `a_from_b @ b_from_c` is `a_from_c`. Lengths in m, angles in rad."""

import math

import numpy as np
import numpy.typing as npt

from ur_nodes.geometry.pose import Pose2, Pose3

Floats = npt.NDArray[np.float64]


def identity() -> Floats:
    """Return the identity."""
    return np.eye(4)


def make_rigid(rotation: Floats, translation: Floats) -> Floats:
    """Make a transform from a rotation matrix (3, 3) and a translation (3,)."""
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = rotation, np.ravel(translation)
    return made


def invert(transform: Floats) -> Floats:
    """Invert a rigid transform."""
    rotation = transform[:3, :3].T
    return make_rigid(rotation, -rotation @ transform[:3, 3])


def from_pose(pose: Pose3) -> Floats:
    """Convert a pose with a unit quaternion."""
    x, y, z, w = pose.rotation
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return make_rigid(rotation, np.array(pose[:3]))


def to_pose(transform: Floats) -> Pose3:
    """Convert to a pose with a unit quaternion."""
    x, y, z = transform[:3, 3].tolist()
    return Pose3(x, y, z, *to_quaternion(transform))


def to_quaternion(transform: Floats) -> tuple[float, float, float, float]:
    """Return the rotation as a quaternion x, y, z, w with w >= 0 (Shepperd's method: the largest of the four first)."""
    m = transform[:3, :3]
    squares = [1 + 2 * m[i, i] - np.trace(m) for i in range(3)] + [1 + np.trace(m)]
    largest = int(np.argmax(squares))
    s = 2.0 * math.sqrt(float(squares[largest]))
    if largest == 3:
        q = [(m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s, s / 4]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q = [0.0, 0.0, 0.0, (m[k, j] - m[j, k]) / s]
        q[i], q[j], q[k] = s / 4, (m[i, j] + m[j, i]) / s, (m[i, k] + m[k, i]) / s
    sign = -1.0 if q[3] < 0 else 1.0
    return float(sign * q[0]), float(sign * q[1]), float(sign * q[2]), float(sign * q[3])


def from_angles(translation: tuple[float, ...], angles: tuple[float, ...]) -> Floats:
    """Make a transform from x, y, z and roll, pitch, yaw about fixed axes, as in URDF."""
    (cr, cp, cy), (sr, sp, sy) = [[f(a) for a in angles] for f in (math.cos, math.sin)]
    rotation = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return make_rigid(rotation, np.asarray(translation, np.float64))


def to_angles(transform: Floats) -> tuple[float, float, float]:
    """Return roll, pitch, yaw about fixed axes; roll is 0 if roll and yaw cannot be distinguished."""
    m = transform[:3, :3]
    pitch = math.asin(max(-1.0, min(1.0, -float(m[2, 0]))))
    if math.hypot(m[0, 0], m[1, 0]) < 1e-9:
        return 0.0, pitch, math.atan2(-m[0, 1], m[1, 1])
    return math.atan2(m[2, 1], m[2, 2]), pitch, math.atan2(m[1, 0], m[0, 0])


def from_planar(pose: Pose2) -> Floats:
    """Convert a planar pose."""
    return from_angles((pose.x, pose.y, 0.0), (0.0, 0.0, pose.yaw))


def to_planar(transform: Floats) -> Pose2:
    """Return the planar part of a pose."""
    return Pose2(float(transform[0, 3]), float(transform[1, 3]), math.atan2(transform[1, 0], transform[0, 0]))


def angle_between(a: Floats, b: Floats) -> float:
    """Return the angle between two rotations, rad, 0 to pi."""
    cosine = (float(np.trace(a[:3, :3].T @ b[:3, :3])) - 1.0) / 2.0
    return math.acos(max(-1.0, min(1.0, cosine)))


def skew(vector: Floats) -> Floats:
    """Return the matrix of the cross product with a vector: its product with b is vector x b."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
