"""Planar poses without ROS: what pure modules and messages agree on."""

from __future__ import annotations

import math
from typing import NamedTuple


class Pose2(NamedTuple):
    """A planar pose: m, m, rad."""

    x: float
    y: float
    yaw: float

    def compose(self, other: Pose2) -> Pose2:
        """The pose `other`, given in this pose's frame, in this pose's parent frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2(
            self.x + c * other.x - s * other.y, self.y + s * other.x + c * other.y, wrap_angle(self.yaw + other.yaw)
        )

    def inverse(self) -> Pose2:
        """The parent frame's pose in this pose's frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2(-c * self.x - s * self.y, s * self.x - c * self.y, -self.yaw)


def wrap_angle(angle: float) -> float:
    """The same direction in (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)
