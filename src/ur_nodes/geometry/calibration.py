"""Calibration while a robot drives: the mount of its lidar, and the radius and the separation of its wheels.

Hand-eye calibration in the plane: a motion that the scans show is that of the wheels, seen in a frame that is shifted
and turned against the robot's (Censi et al., Simultaneous calibration of odometry and sensor parameters for mobile
robots, 2013).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

_LONG, _FAR = 0.5, 0.5  # m, rad: motions so large are compared
_SLIPPED = (0.1, 0.15)  # m or rad, share: the wheels slipped where lengths or turns differ by more
_ARM, _FLOOR = 0.15, 0.05  # m from the robot's middle to a wheel; m rolled that err as much as two scans
_FEWEST, _LEAST_WAY = 20, 10.0  # motions, m
_LEAST_NOISE = 0.002  # m or rad, of one of them
_CERTAIN = 4.0  # standard deviations
_PRIOR = np.diag((0.01, 0.0025, 0.0025, 0.0025))  # of a scale of about 1, and of the rest, which is known a little
_TURN_PRIOR = np.diag((0.002, 0.006))  # of turns per turn of about 1, and of rad per m


class Errors(NamedTuple):
    """The differences of a robot from its description: its lidar by a yaw (rad) and a place (m, in the lidar's frame).

    The wheels' radius and separation differ by shares: 0.05 for wheels that are 5 % larger than described.
    """

    yaw: float
    x: float
    y: float
    radius: float
    separation: float


LEAST = Errors(math.radians(1.0), 0.015, 0.015, 0.01, 0.01)
"""Smaller errors are as good as none: what is measured by hand is as exact."""


@dataclass(frozen=True, slots=True)
class CalibrationFigures:
    """The errors that a drive of so many `metres` has shown, and their standard deviations."""

    metres: float
    errors: Errors
    deviations: Errors

    @property
    def clear(self) -> Errors:
        """The errors that are certain and matter; the others are 0."""
        rows = zip(self.errors, self.deviations, LEAST, strict=True)
        return Errors(*(each if abs(each) > max(least, _CERTAIN * dev) else 0.0 for each, dev, least in rows))


def with_turn(motion: Pose2, yaw: float) -> Pose2:
    """Return the motion of the same length on an arc that turns by `yaw` rad."""
    half = 0.5 * (yaw - motion.yaw)  # the chord lies halfway between both headings
    c, s = math.cos(half), math.sin(half)
    return Pose2(c * motion.x - s * motion.y, s * motion.x + c * motion.y, yaw)


class MotionCalibration:
    """Compares the motions between scans as odometry and as the scans have them."""

    def __init__(self) -> None:
        self._places, self._turns = _LeastSquares(_PRIOR), _LeastSquares(_TURN_PRIOR)
        self._metres = 0.0
        self.forget()

    def forget(self) -> None:
        """Begin the present motion again, for example after a scan that shows no motion for certain."""
        self._wheels = self._scans = Pose2(0.0, 0.0, 0.0)  # of the present motion, with the turns of the scans
        self._way = self._turned = 0.0  # by the wheels: m, and rad to either side
        self._turn = np.zeros(2)  # by the wheels and by the scans, rad

    def add(self, reported: Pose2, shown: Pose2) -> None:
        """Take the motion between two scans of a lidar."""
        self._wheels = self._wheels.compose(with_turn(reported, shown.yaw))  # the wheels turn less exactly
        self._scans = self._scans.compose(shown)
        self._way += math.hypot(reported.x, reported.y)
        self._turned += abs(reported.yaw)
        self._turn += (reported.yaw, shown.yaw)
        if self._way < _LONG and self._turned < _FAR:
            return
        wheels, scans, way, (turn, real) = self._wheels, self._scans, self._way, self._turn.tolist()
        weight = 1.0 / math.sqrt(_FLOOR + way + _ARM * self._turned)  # wheels err more, the farther they roll
        self.forget()
        length, far = math.hypot(*wheels[:2]), math.hypot(*scans[:2])
        if _differ(length, far) or _differ(turn, real):
            return
        # Two equations for a scale and a rotation (as two numbers) of the motion, and a shift of the frame
        c, s = math.cos(real), math.sin(real)
        rows = np.array(((wheels.x, -wheels.y, 1.0 - c, s), (wheels.y, wheels.x, -s, 1.0 - c)))
        self._places.add(rows, np.array(scans[:2]))
        # One for turns per turn, and for a turn per metre, of wheels that are not alike
        self._turns.add(weight * np.array(((turn, way),)), np.array((weight * real,)))
        self._metres += far

    def figures(self, described: Pose2) -> CalibrationFigures | None:
        """Return what the motions have shown of a robot with a lidar at this pose; None: not enough yet."""
        if self._places.count < 2 * _FEWEST or self._metres < _LEAST_WAY:
            return None
        (along, across, x, y), (_, sideways, dx, dy) = self._places.solve()
        (turns, _), (spread, _) = self._turns.solve()
        frame = Pose2(x, y, math.atan2(across, along))
        shift = described.inverse().compose(frame.inverse().compose(described))
        scale = math.hypot(along, across)
        errors = Errors(shift.yaw, shift.x, shift.y, scale - 1.0, scale / turns - 1.0)
        deviations = Errors(sideways, dx, dy, sideways, math.hypot(sideways, spread))
        return CalibrationFigures(self._metres, errors, deviations)


def _differ(one: float, other: float) -> bool:
    return abs(one - other) > _SLIPPED[0] + _SLIPPED[1] * abs(one)


class _LeastSquares:
    """Sums of linear equations whose unknowns are about 1, 0, 0 ...; `count` is their number."""

    def __init__(self, prior: NDArray[np.float64]) -> None:
        """`prior` is the information of it, in the unit of the noise of an equation."""
        self._information, self._sums = prior.copy(), prior[0].copy()
        self._squares = float(prior[0, 0])
        self.count = 0

    def add(self, rows: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Add equations: `rows` (m, n) times the unknowns are `values` (m)."""
        self._information += rows.T @ rows
        self._sums += rows.T @ values
        self._squares += float(values @ values)
        self.count += len(values)

    def solve(self) -> tuple[list[float], list[float]]:
        """Return the unknowns, and their standard deviations."""
        covariance = np.linalg.inv(self._information)
        found = covariance @ self._sums
        noise = math.sqrt(max(self._squares - float(found @ self._sums), 0.0) / self.count)
        return found.tolist(), (max(noise, _LEAST_NOISE) * np.sqrt(np.diag(covariance))).tolist()
