"""Rigid poses in three dimensions, in m and rad (URDF's fixed-axis roll, pitch, yaw)."""

from __future__ import annotations

import math
from dataclasses import dataclass

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]

_UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class Pose:
    """A rotation, then a translation: the pose of one frame in another."""

    at: Vector = (0.0, 0.0, 0.0)
    rotation: Matrix = _UNIT

    def apply(self, point: Vector) -> Vector:
        """Transform a point from this frame to the other one."""
        x, y, z = self.turn(point)
        return x + self.at[0], y + self.at[1], z + self.at[2]

    def turn(self, direction: Vector) -> Vector:
        """Rotate a direction from this frame to the other one."""
        a, b, c = (sum(r * d for r, d in zip(row, direction, strict=True)) for row in self.rotation)
        return a, b, c

    def then(self, inner: Pose) -> Pose:
        """Return the pose `inner`, which is given in this frame, in the other frame."""
        columns = [self.turn(column) for column in _transposed(inner.rotation)]
        return Pose(self.apply(inner.at), _transposed((columns[0], columns[1], columns[2])))

    def angles(self) -> Vector:
        """Return roll, pitch and yaw; roll is 0 at a pitch of a quarter turn (gimbal lock)."""
        (xx, xy, _), (yx, yy, _), (zx, zy, zz) = self.rotation
        pitch = math.asin(max(-1.0, min(1.0, -zx)))
        if abs(zx) > 1.0 - 1e-9:
            return 0.0, pitch, math.atan2(-xy, yy)
        return math.atan2(zy, zz), pitch, math.atan2(yx, xx)


def make_pose(at: Vector, angles: Vector) -> Pose:
    """Return the pose of URDF's `xyz` and `rpy`: rotated about the fixed x, then y, then z axis."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in angles)
    return Pose(
        at,
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        ),
    )


def _transposed(matrix: Matrix) -> Matrix:
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return (a, d, g), (b, e, h), (c, f, i)
