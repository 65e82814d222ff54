"""The share of the motion that wheels claim which two scans confirm.

Each direction in which that motion would have changed the ranges is a witness: near 0 the wheels slip, near 1 the
robot moves. Ranges are averaged in it, and directions left out in which a small error of the claimed turn changes
them as much: along the walls of a corridor without a feature, noise looks like either.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

_STEP = (0.06, 0.12)  # m, rad of claimed motion between two scans that are compared
_GAP, _EDGE = 0.06, 0.5  # rad, and share of the range: neighbouring beams with more between them meet different things
_CHANGE = 0.4  # of the claimed motion: sectors whose ranges change by less do not matter
_CERTAIN = 3.0  # standard errors of that change
_TURN = 0.01  # rad: an error of the claimed turn that must change less
_SECTORS, _BEAMS, _FEWEST = 12, 3, 3  # of the turn; beams in one that counts; such sectors: a person fills two at most
_SLIP, _MOVES = 0.3, 0.6  # less of the claimed motion is none; more is all of it


def confirmed_share(
    before: NDArray[np.float64], after: NDArray[np.float64], moved: Pose2, sensor: tuple[float, float]
) -> float | None:
    """Return the share of a claimed motion that two scans confirm; None where they cannot tell.

    `before` (n, 2) and `after` (m, 2) are the ends of beams in the robot's frame, m; `moved` is the later pose of the
    robot in its earlier frame, `sensor` the place of the lidar in the robot's frame.
    """
    if not len(before) or not len(after):
        return None
    bearings, ranges = _polar(after, sensor)
    still, near_still = _ranges_at(bearings, *_polar(before, sensor))
    driven, near_driven = _ranges_at(bearings, *_polar(moved.inverse().transform_points(before), sensor))
    askew = moved.compose(Pose2(0.0, 0.0, _TURN)).inverse().transform_points(before)
    seen, change, doubt = ranges - still, driven - still, _ranges_at(bearings, *_polar(askew, sensor))[0] - driven
    reach = max(math.hypot(moved.x, moved.y), 0.5 * abs(moved.yaw))
    counts = near_still & near_driven & (np.maximum(np.abs(change), np.abs(seen)) < 3.0 * reach)
    bearings, change, seen, doubt = (each[counts] for each in (bearings, change, seen, doubt))
    sectors = np.minimum((bearings / (math.tau / _SECTORS)).astype(np.intp), _SECTORS - 1)  # -1e-20 + tau is tau
    beams = np.bincount(sectors, minlength=_SECTORS)
    some = np.maximum(beams, 1)
    expected, shown, unsure = (np.bincount(sectors, each, _SECTORS) / some for each in (change, seen, doubt))
    spread = np.sqrt(np.bincount(sectors, (change - expected[sectors]) ** 2, _SECTORS)) / some
    least = np.maximum(np.maximum(_CHANGE * reach, _CERTAIN * spread), np.abs(unsure))
    clear = (beams >= _BEAMS) & (np.abs(expected) > least)
    shares = sorted((shown[clear] / expected[clear]).tolist())
    half = len(shares) // 2
    return 0.5 * (shares[half] + shares[-half - 1]) if len(shares) >= _FEWEST else None  # np.median takes 40 us


def _polar(points: NDArray[np.float64], sensor: tuple[float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return bearings (n), ascending, 0 to 2 pi, and ranges (n) of points (n, 2)."""
    x, y = points[:, 0] - sensor[0], points[:, 1] - sensor[1]
    bearings = _in_turn(np.arctan2(y, x))
    order = np.argsort(bearings)
    return bearings[order], np.maximum(np.hypot(x, y)[order], 1e-3)


def _in_turn(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles (n) between -2 and 2 pi as 0 to 2 pi: what % does, in a tenth of its time."""
    return np.where(angles < 0.0, angles + math.tau, angles)


def _ranges_at(
    wanted: NDArray[np.float64], bearings: NDArray[np.float64], ranges: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the ranges (n) in wanted directions (n), on the line between two beams, and which have such beams."""
    above = np.searchsorted(bearings, wanted)
    above[above == len(bearings)] = 0
    below = bearings[above - 1]
    gap = _in_turn(bearings[above] - below)
    far, near = ranges[above], ranges[above - 1]
    along = _in_turn(wanted - below) / np.maximum(gap, 1e-9)
    there = (gap <= _GAP) & (np.abs(far - near) < _EDGE * np.minimum(far, near))
    return 1.0 / (along / far + (1.0 - along) / near), there


class MotionWitness:
    """Compares scans one after the other. `slipped` is how far (m, or rad) the wheels have turned in vain by now.

    `moves`: the newest scan has confirmed what the wheels claim.
    """

    def __init__(self) -> None:
        self.slipped = 0.0
        self.moves = False
        self._last: tuple[Pose2, NDArray[np.float64]] | None = None

    def update(self, odometry: Pose2, points: NDArray[np.float64], sensor: tuple[float, float]) -> Pose2 | None:
        """Take a scan: the ends (n, 2) of its beams in the robot's frame, and the odometry of its time.

        Returns how much of the claimed motion since the scan before, in the robot's frame then, did not happen.
        """
        before, self._last = self._last, self._last or (odometry, points)
        if before is None:
            return None
        moved = before[0].inverse().compose(odometry)
        way = math.hypot(moved.x, moved.y)
        if way < _STEP[0] and abs(moved.yaw) < _STEP[1]:
            return None
        self._last = (odometry, points)
        share = confirmed_share(before[1], points, moved, sensor)
        self.moves = share is not None and share > _MOVES
        self.slipped = self.slipped + max(way, abs(moved.yaw)) if share is not None and abs(share) < _SLIP else 0.0
        if share is None or share > _MOVES:
            return None
        rest = 1.0 - max(0.0, share)  # it slides along something
        return Pose2(rest * moved.x, rest * moved.y, rest * moved.yaw)

    def restart(self) -> None:
        """Begin anew with the next scan."""
        self.slipped, self.moves, self._last = 0.0, False, None
