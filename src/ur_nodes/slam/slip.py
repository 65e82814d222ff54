"""Wheel slip: odometry that differs from the motion by the scans by more than its usual errors."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from ur_nodes.geometry.pose import Pose2, wrap_angle

_SCANS = 20  # over which both motions are compared
_LEAST = (0.15, 0.3)  # m, rad: smaller differences are usual
_SHARE = 0.5  # of the distance by odometry: likewise


@dataclass(frozen=True, slots=True)
class Slip:
    """The same motion as odometry `reported` it and as the scans have `shown` it."""

    reported: Pose2
    shown: Pose2


class SlipWatch:
    """Compares the motions between scans by odometry and by the scans."""

    def __init__(self) -> None:
        self._steps: deque[tuple[Pose2, Pose2]] = deque(maxlen=_SCANS)

    def forget(self) -> None:
        """Restart, for example after a scan whose motion is uncertain."""
        self._steps.clear()

    def add(self, reported: Pose2, shown: Pose2) -> Slip | None:
        """Add the motion between two scans; returns a detected slip, and then restarts."""
        self._steps.append((reported, shown))
        whole = Pose2(0.0, 0.0, 0.0)
        other = Pose2(0.0, 0.0, 0.0)
        for by_wheels, by_scans in self._steps:
            whole, other = whole.compose(by_wheels), other.compose(by_scans)
        apart = math.hypot(whole.x - other.x, whole.y - other.y)
        turned = abs(wrap_angle(whole.yaw - other.yaw))
        if apart <= max(_LEAST[0], _SHARE * math.hypot(whole.x, whole.y)) and turned <= _LEAST[1]:
            return None
        self._steps.clear()
        return Slip(whole, other)
