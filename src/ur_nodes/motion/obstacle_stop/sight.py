"""Points that the sensors of a base have seen near it, in the frame of odometry, as steps from reading to reading.

A reading replaces the one before of the same sensor. Points that have left the field of view of their sensor are
remembered for `MEMORY` s. What is nearer than a sensor can measure (-inf, REP 117) counts as at its least range.
"""

import math
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.hull import Floats, Hull
from ur_nodes.geometry.pose import Pose2, arc_end, wrap_angle
from ur_nodes.geometry.scan import classify_ranges, directions_of_beams, ends_of_beams
from ur_nodes.motion.obstacle_stop.sensors import RangeSensor

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
        """Poses (n, 3) at times (n) in any order that lie close together, by the poses at the first and the last."""
        begin, end = float(times.min()), float(times.max())
        first, last = self.pose_at(begin), self.pose_at(end)
        share = ((times - begin) / max(end - begin, 1e-9))[:, None]
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


MEMORY = 3.0  # s
_OWN = 0.03  # m: what lies deeper within the outline is a part of the robot
_LEAST_MEASURED = 0.1  # of the beams: with fewer measurements a scan has seen nothing
_ARC = 7  # points of a sonar's arc
_SLACK = 0.05  # m: a point at most so far beyond an echo has made it
_MOST = 500  # points that are remembered
Contact = Literal["bumper", "cliff"]
_NONE: Floats = np.empty((0, 2))
_NOT_TOUCHED: dict[tuple[Contact, str], Floats] = {}


@dataclass(frozen=True, slots=True, eq=False)
class SensorRanges:
    """A scan, or the range of a sonar: `ranges` (n) in m, `limits` the least and the greatest that count.

    `at` is when the first was measured (s of the mux's clock), the last was so `turn` s later: negative for a lidar
    that turns clockwise. `increment` (rad) is from one to the next, `first` (rad) the angle of the first. `cone` is the
    full angle of a sonar, rad; 0 for a lidar.
    """

    ranges: NDArray[np.floating]
    limits: tuple[float, float]
    at: float
    first: float = 0.0
    increment: float = 0.0
    turn: float = 0.0
    cone: float = 0.0

    @property
    def begun(self) -> float:
        """The time (s) of what was measured first."""
        return self.at + min(0.0, self.turn)


@dataclass(frozen=True, slots=True, eq=False)
class SeenPoints:
    """Points (n, 2) in the frame of odometry that a sensor saw at a time (s)."""

    points: Floats
    at: float


@dataclass(frozen=True, slots=True, eq=False)
class RememberedPoints:
    """Points (n, 2) in the frame of odometry that left the field of view of their sensor, and when each was seen."""

    points: Floats = field(default_factory=lambda: _NONE)
    times: Floats = field(default_factory=lambda: np.empty(0))


_NOT_SEEN: dict[str, SeenPoints] = {}


class Sight(NamedTuple):
    """The track of the base, the newest points of each sensor, older ones, and touched ones.

    `touched` holds the points of the outline (n, 2), in the base's frame, of pressed bumpers and of cliffs by name.
    """

    hull: Hull
    sensors: tuple[RangeSensor, ...]
    reach: float  # m from the origin of the base: what is further away is left out
    track: Track = Track()
    seen: dict[str, SeenPoints] = _NOT_SEEN
    memory: RememberedPoints = RememberedPoints()
    touched: dict[tuple[Contact, str], Floats] = _NOT_TOUCHED

    def points_at(self, now: float) -> Floats:
        """All points (n, 2) in the base's frame at `now`, remembered ones included, touched ones not."""
        kept = [each.points for each in self.seen.values() if len(each.points) and now - each.at <= MEMORY]
        if len(self.memory.points):
            kept.append(self.memory.points[now - self.memory.times <= MEMORY])
        if not kept:
            return _NONE
        return self.track.pose_at(now).inverse().transform_points(np.concatenate(kept))

    def age(self, sensor: RangeSensor, now: float) -> float:
        """Return the seconds since a sensor measured; infinite before the first reading."""
        seen = self.seen.get(sensor.name)
        return math.inf if seen is None else now - seen.at


def move(sight: Sight, reading: Odometer) -> Sight:
    """Return the sight after a reading of odometry."""
    track, same = follow(sight.track, reading)
    return sight._replace(track=track) if same else sight._replace(track=track, seen={}, memory=RememberedPoints())


def touch(sight: Sight, contact: tuple[Contact, str], points: Floats | None) -> Sight:
    """The sight after a bumper or cliff sensor: the points (n, 2) of the outline that it covers, None for released."""
    touched = {each: where for each, where in sight.touched.items() if each != contact}
    return sight._replace(touched=touched if points is None else {**touched, contact: points})


def look(sight: Sight, sensor: RangeSensor, reading: SensorRanges) -> Sight:
    """Return the sight after a reading of a sensor; a reading without a measurement changes nothing."""
    before = sight.seen.get(sensor.name)
    if before is not None and reading.begun < before.at:
        return sight
    ranges = np.asarray(reading.ranges, dtype=np.float64)
    returns = classify_ranges(ranges, reading.limits)
    hits = returns.near | returns.hits
    if not len(ranges) or np.count_nonzero(hits | returns.clear) < _LEAST_MEASURED * len(ranges):
        return sight
    ends = _ends(sight, sensor, reading, np.where(returns.near, reading.limits[0], ranges), hits)
    seen = dict(sight.seen)
    seen[sensor.name] = SeenPoints(ends, reading.begun)
    return sight._replace(seen=seen, memory=_remember(sight, sensor, reading, before))


def _remember(sight: Sight, sensor: RangeSensor, reading: SensorRanges, before: SeenPoints | None) -> RememberedPoints:
    """The points that a reading does not measure: of the memory, and of the reading before of the same sensor."""
    memory = sight.memory
    points, times = memory.points, memory.times
    if before is not None and len(before.points):
        points = np.concatenate((points, before.points))
        times = np.concatenate((times, np.full(len(before.points), before.at)))
    if not len(points):
        return memory
    first, middle, last = (sight.track.pose_at(reading.at + share * reading.turn) for share in (0.0, 0.5, 1.0))
    local = middle.inverse().transform_points(points)
    turned = wrap_angle(last.yaw - first.yaw)  # an arc stays unseen where the base turns against the lidar
    kept = (reading.begun - times <= MEMORY) & _hidden(sensor, reading, local, turned)
    kept &= np.hypot(*local.T) <= sight.reach
    return RememberedPoints(points[kept][-_MOST:], times[kept][-_MOST:])


def _hidden(sensor: RangeSensor, reading: SensorRanges, points: Floats, turned: float) -> NDArray[np.bool_]:
    """Return which earlier points (n, 2) of the base's frame a reading does not measure.

    `turned` (rad) is by how much the base has, from its first to its last beam.
    """
    hidden = ~sensor.sees(points, turned)
    if reading.cone:
        hidden |= np.hypot(*(points - sensor.mount.offset[:2]).T) > reading.ranges[0] + _SLACK
    return hidden


def _ends(sight: Sight, sensor: RangeSensor, reading: SensorRanges, ranges: Floats, hits: NDArray[np.bool_]) -> Floats:
    """The points (n, 2) in the frame of odometry where beams have ended near the base, its own parts left out."""
    if reading.cone and not hits[0]:
        return _NONE
    if reading.cone:
        angles = np.linspace(-reading.cone / 2.0, reading.cone / 2.0, _ARC)
        directions = np.column_stack((np.cos(angles), np.sin(angles)))
        ranges, numbers = np.broadcast_to(ranges, _ARC), np.zeros(_ARC)
    else:
        hits = hits & (ranges <= sight.reach + float(np.hypot(*sensor.mount.offset[:2])))
        directions = directions_of_beams(len(ranges), reading.first, reading.increment)[hits]
        ranges, numbers = ranges[hits], np.nonzero(hits)[0].astype(np.float64)
    points = ends_of_beams(directions, ranges, sensor.mount)
    near = np.hypot(*points.T) <= sight.reach
    if not near.any():
        return _NONE
    near[near] = sight.hull.distances(points[near]) >= -_OWN
    points, numbers = points[near], numbers[near]
    if not len(points):
        return _NONE
    poses = sight.track.poses_at(reading.at + reading.turn / max(1, len(hits) - 1) * numbers)
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    moved = np.column_stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]))
    ends: Floats = moved + poses[:, :2]
    return ends
