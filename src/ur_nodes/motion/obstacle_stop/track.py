"""The recent track of a base by odometry: its pose when a sensor measured, and now."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, arc_end, wrap_angle

_KEPT = 40  # readings
_AHEAD = 0.3  # s that the newest velocity is taken to last
_JUMP = 0.5  # m or rad beyond what the velocity explains: odometry was reset


@dataclass(frozen=True, slots=True)
class Odometer:
    """A reading of odometry at the time `at` (s of the mux's clock): the pose; m/s forward, rad/s, m/s to the left."""

    pose: Pose2
    forward: float
    turn: float
    at: float
    left: float = 0.0

    def pose_after(self, seconds: float) -> Pose2:
        """The pose after a time with the velocity of the reading."""
        return self.pose.compose(arc_end(self.forward * seconds, self.turn * seconds, self.left * seconds))


@dataclass(frozen=True, slots=True)
class Track:
    """Readings of odometry, the oldest first; without any, the base is assumed to be at rest."""

    readings: tuple[Odometer, ...] = ()

    def age(self, now: float) -> float:
        """Return the seconds since the newest reading; infinite before the first."""
        return now - self.readings[-1].at if self.readings else math.inf

    def pose_at(self, at: float) -> Pose2:
        """The pose at a time (s): between two readings, or beyond the newest by its velocity for 0.3 s at most."""
        if not self.readings:
            return Pose2(0.0, 0.0, 0.0)
        if at <= self.readings[0].at:
            return self.readings[0].pose
        for before, after in zip(self.readings[-2::-1], self.readings[:0:-1], strict=True):
            if before.at <= at < after.at:
                share = (at - before.at) / (after.at - before.at)
                x, y = (b + share * (a - b) for b, a in zip(before.pose[:2], after.pose[:2], strict=True))
                return Pose2(x, y, before.pose.yaw + share * wrap_angle(after.pose.yaw - before.pose.yaw))
        newest = self.readings[-1]
        seconds = min(at - newest.at, _AHEAD)
        return newest.pose_after(seconds)

    def poses_at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Poses (n, 3) at times (n) that lie close together, by the poses at the first and the last."""
        first, last = self.pose_at(float(times[0])), self.pose_at(float(times[-1]))
        share = ((times - times[0]) / max(times[-1] - times[0], 1e-9))[:, None]
        change = np.array((last.x - first.x, last.y - first.y, wrap_angle(last.yaw - first.yaw)))
        poses: NDArray[np.float64] = np.array(first) + share * change
        return poses


def follow(track: Track, reading: Odometer) -> tuple[Track, bool]:
    """Return the track with one more reading; False if odometry was reset, which makes earlier poses invalid."""
    if not track.readings:
        return Track((reading,)), True
    newest = track.readings[-1]
    if reading.at <= newest.at:
        return track, True
    expected = newest.pose_after(reading.at - newest.at)
    far = math.hypot(reading.pose.x - expected.x, reading.pose.y - expected.y)
    if far > _JUMP or abs(wrap_angle(reading.pose.yaw - expected.yaw)) > _JUMP:
        return Track((reading,)), False
    return Track((*track.readings[-_KEPT:], reading)), True
