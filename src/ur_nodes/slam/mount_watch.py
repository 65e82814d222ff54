"""A lidar that is mounted otherwise than described: the wheels and the scans show motions that differ by the mount.

Hand-eye calibration in the plane: a motion that the scans show is that of the wheels, seen in a frame that is shifted
and turned against the robot's (Censi et al., Simultaneous calibration of odometry and sensor parameters for mobile
robots, 2013).
"""

import math
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.prediction import with_turn

_LONG, _FAR = 0.3, 0.4  # m, rad: motions so large are compared
_SLIPPED = 0.1  # m: the wheels slipped where the two differ by more
_FEWEST = 40  # motions
_LEAST_NOISE = 0.002  # m, of one of them
_CERTAIN = 4.0  # standard deviations
_LEAST = (0.015, 0.015, math.radians(1.0))  # m, m, rad: what is measured by hand is as exact
_PRIOR = np.diag((0.01, 0.0025, 0.0025, 0.0025))  # of a scale of about 1, and of the rest, which is known a little


@dataclass(frozen=True, slots=True)
class MountError:
    """The pose of a lidar on the robot, in the plane: as `described`, and as the motions have `shown` it.

    What they do not show for certain is as described.
    """

    described: Pose2
    shown: Pose2


class MountWatch:
    """Compares the motions between scans as odometry and as the scans have them, until an error is certain."""

    def __init__(self) -> None:
        self._wheels = self._scans = Pose2(0.0, 0.0, 0.0)  # of the present motion, with the turns of the scans
        self._information, self._sums = _PRIOR.copy(), _PRIOR[0].copy()
        self._squares = float(_PRIOR[0, 0])
        self._count = 0
        self._noticed = False

    def forget(self) -> None:
        """Begin the present motion again, for example after a scan that shows no motion for certain."""
        self._wheels = self._scans = Pose2(0.0, 0.0, 0.0)

    def add(self, reported: Pose2, shown: Pose2, described: Pose2) -> MountError | None:
        """Take the motion between two scans of a lidar; return what was noticed, at most once."""
        if self._noticed:
            return None
        self._wheels = self._wheels.compose(with_turn(reported, shown.yaw))  # the wheels turn less exactly
        self._scans = self._scans.compose(shown)
        if math.hypot(*self._wheels[:2]) < _LONG and abs(self._scans.yaw) < _FAR:
            return None
        wheels, scans = self._wheels, self._scans
        self.forget()
        if math.dist(wheels[:2], scans[:2]) > _SLIPPED:
            return None
        # Add two equations for a scale and a rotation (as two numbers) of the motion, and a shift of the frame
        c, s = math.cos(scans.yaw), math.sin(scans.yaw)
        rows = np.array(((wheels.x, -wheels.y, 1.0 - c, s), (wheels.y, wheels.x, -s, 1.0 - c)))
        self._information += rows.T @ rows
        self._sums += rows.T @ scans[:2]
        self._squares += scans.x**2 + scans.y**2
        self._count += 1
        if self._count < _FEWEST:
            return None
        covariance = np.linalg.inv(self._information)
        along, across, x, y = found = covariance @ self._sums
        squares = max(self._squares - float(found @ self._sums), 0.0) / (2 * self._count)
        noise = max(math.sqrt(squares), _LEAST_NOISE)
        deviations = _CERTAIN * noise * np.sqrt(np.diag(covariance))
        frame = Pose2(float(x), float(y), math.atan2(across, along))
        errors = described.inverse().compose(frame.inverse().compose(described))
        limits = np.maximum(_LEAST, (deviations[2], deviations[3], deviations[1]))
        clear = [error if abs(error) > limit else 0.0 for error, limit in zip(errors, limits.tolist(), strict=True)]
        self._noticed = any(clear)
        return MountError(described, described.compose(Pose2(*clear))) if self._noticed else None
