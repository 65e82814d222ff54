"""Legs of a path, driven one after the other: a turn on the spot if needed, then along the points."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.planning.legs import Leg, bearing_of, legs_of_motions
from ur_nodes.navigation.planning.outline_motions import LEFT, RIGHT, MotionPose, course_of, direction_of
from ur_nodes.navigation.planning.path_geometry import Points, nearest_index
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import LocalCommand, follow_reference, sweep_is_free
from ur_nodes.navigation.steering.rollout import FollowSettings, ReferencePath, RolloutState, make_reference
from ur_nodes.navigation.steering.speed_profile import SpeedLimits, approach, brake, speed_shares, turn_towards

_BACK = 0.2  # m/s, at most, while a leg is driven back
_ARRIVED = 0.015  # m from the end of a leg
_NO_LENGTH = 0.001  # m between points of a path that ends where it begins
_ALIGNED = 0.03  # rad
_STILL = 0.02  # m/s
_SLOW_TURN = 0.15  # rad/s
_LONG_TURN = 2.0  # rad: a planned turn by more is made in its direction, as the other may be blocked
_NEAR, _NEAREST = 0.4, 0.12  # s, m: preview on a path that was made for the outline, whose bends are short
_MOST_POINTS = 40  # of the path that the robot may pass in a period


@dataclass(frozen=True, slots=True)
class Driving:
    """Settings of a drive along legs: the robot, its limits, and its steering; `period` in s."""

    footprint: Footprint
    limits: SpeedLimits
    follow: FollowSettings
    period: float


@dataclass(frozen=True, slots=True)
class LegStep:
    """One control period: the command; `away` (m) from the end of the last leg if `ended`, else off the path."""

    command: LocalCommand
    away: float
    ended: bool = False


class LegFollower:
    """Legs in a frame, most often the map, whose pose in the odometry frame each step gets."""

    def __init__(self, legs: Sequence[Leg]) -> None:
        self._legs = tuple(legs)
        self._number = 0
        self._index = 0
        self._aligned = self._legs[0].turned is None
        self._reference: ReferencePath | None = None
        self._made_for: tuple[Pose2, Grid | None, SpeedLimits] | None = None

    @property
    def rest(self) -> Points:
        """The points (n, 2) that are still to be driven along, in the frame of the legs."""
        later = [leg.points for leg in self._legs[self._number + 1 :]]
        return np.concatenate((self._legs[self._number].points[self._index :], *later))

    @property
    def is_tight(self) -> bool:
        """True when the path was searched for the outline, so that the robot should not be far beside it."""
        return any(leg.course is not None for leg in self._legs)

    def step(
        self, motion: RolloutState, local: LocalObstacles, odom: Pose2, speed_mask: Grid | None, driving: Driving
    ) -> LegStep:
        """Continue; `motion` has the speeds that were sent last."""
        leg = self._legs[self._number]
        if not self._aligned and not driving.limits.radius:
            turned = self._align(leg, motion, local, odom, driving)
            if turned is not None:
                return LegStep(turned, 0.0)
        base = motion
        if leg.gear != 1:
            motion, driving = _along_gear(motion, leg.gear), _driving_in(driving, leg.gear)
        reference = self._refer(leg, odom, speed_mask, driving.limits)
        x, y = motion.pose.x, motion.pose.y
        last = min(self._index + _MOST_POINTS, reference.end + 1)
        self._index = nearest_index(reference.points, x, y, self._index, last)
        end_x, end_y = reference.points[reference.end].tolist()
        away = math.hypot(end_x - x, end_y - y)
        if self._index >= reference.end or away < _ARRIVED or reference.spacing < _NO_LENGTH:
            resting = math.hypot(motion.speed, motion.left) < _STILL
            if self._number == len(self._legs) - 1:
                return LegStep(_brake(base, driving), away, ended=True)
            if resting:
                self._number, self._index, self._reference = self._number + 1, 0, None
                self._aligned = self._legs[self._number].turned is None
            return LegStep(_brake(base, driving), 0.0)
        found = follow_reference(
            reference,
            self._index,
            motion,
            local,
            driving.footprint,
            driving.limits,
            driving.follow if leg.course is None else replace(driving.follow, preview=_NEAR, preview_least=_NEAREST),
            driving.period,
        )
        astray = math.hypot(*(reference.points[self._index] - (x, y)))
        return LegStep(_in_base(found, motion.left, leg.gear, driving), astray)

    def _align(
        self, leg: Leg, motion: RolloutState, local: LocalObstacles, odom: Pose2, driving: Driving
    ) -> LocalCommand | None:
        """Turn on the spot until the robot points along a leg; None when it does."""
        error = wrap_angle(odom.yaw + bearing_of(leg) - motion.pose.yaw)
        if leg.turned is not None and abs(leg.turned) > _LONG_TURN and error * leg.turned < 0.0 and abs(error) > 0.3:
            error += math.copysign(math.tau, leg.turned)
        slow = math.hypot(motion.speed, motion.left) < _STILL and abs(motion.turn) < _SLOW_TURN
        if abs(error) < _ALIGNED and slow:
            self._aligned = True
            return None
        limits, period = driving.limits, driving.period
        braked = brake(motion.velocity, limits, period)
        turn = turn_towards(error, motion.turn, limits, period)
        here = np.array(motion.pose)[None]
        trial = RolloutState(motion.pose, 0.0, turn)
        if abs(turn) >= _STILL and not sweep_is_free(trial, 0.3, local, driving.footprint):
            return LocalCommand(braked.speed, braked.turn, here, blocked=True, left=braked.left)
        return LocalCommand(braked.speed, turn, here, left=braked.left)

    def _refer(self, leg: Leg, odom: Pose2, speed_mask: Grid | None, limits: SpeedLimits) -> ReferencePath:
        made_for = (odom, speed_mask, limits)
        before = self._made_for
        if (
            self._reference is None
            or before is None
            or before[0] != odom
            or before[1] is not speed_mask
            or before[2] != limits
        ):
            shares = speed_shares(speed_mask, leg.points)
            course = None if leg.course is None else leg.course + odom.yaw
            self._reference = make_reference(odom.transform_points(leg.points), limits, shares, course)
            self._made_for = made_for
        return self._reference


def legs_back(track: Sequence[Pose2], distance: float, *, sideways: bool = False) -> tuple[Leg, ...]:
    """Return the legs that lead back along the poses of a track, oldest first, for at most `distance` m.

    `sideways`: the robot may have driven to its side.
    """
    if len(track) < 2:
        return ()
    motions, length = [MotionPose(*track[-1], 0)], 0.0
    for here, before in zip(reversed(track), list(reversed(track))[1:], strict=False):
        dx, dy = before.x - here.x, before.y - here.y
        step = math.hypot(dx, dy)
        ahead = dx * math.cos(here.yaw) + dy * math.sin(here.yaw)
        aside = dy * math.cos(here.yaw) - dx * math.sin(here.yaw)
        gear = 0 if step < 0.01 else 1 if ahead > 0.0 else -1
        if gear and sideways and abs(aside) > abs(ahead):
            gear = LEFT if aside > 0.0 else RIGHT
        motions.append(MotionPose(*before, gear))
        length += step
        if length >= distance:
            break
    return legs_of_motions(motions)[0]


def _brake(motion: RolloutState, driving: Driving) -> LocalCommand:
    speed, turn, left = brake(motion.velocity, driving.limits, driving.period)
    return LocalCommand(speed, turn, np.array(motion.pose)[None], left=left)


def _along_gear(motion: RolloutState, gear: int) -> RolloutState:
    """Return the motion of a robot whose front is where a gear drives to."""
    c, s = direction_of(gear)
    ahead, left = c * motion.speed + s * motion.left, c * motion.left - s * motion.speed
    return RolloutState(motion.pose.compose(Pose2(0.0, 0.0, course_of(gear))), ahead, motion.turn, left)


def _driving_in(driving: Driving, gear: int) -> Driving:
    """Return the settings of such a robot."""
    (c, s), limits, footprint = direction_of(gear), driving.limits, driving.footprint
    rotation = np.array(((c, -s), (s, c)))  # of row vectors, by the course backwards
    turned = Footprint(
        footprint.outline @ rotation, footprint.inscribed, footprint.circumscribed, footprint.samples @ rotation
    )
    fastest = limits.lateral if s else min(_BACK, limits.speed)
    return replace(driving, footprint=turned, limits=replace(limits, speed=fastest))


def _in_base(found: LocalCommand, across: float, gear: int, driving: Driving) -> LocalCommand:
    """Return a command along a gear as one of the base; what is `across` it (m/s) is braked."""
    across = approach(across, 0.0, driving.limits.acceleration * driving.period)
    if gear == 1 and not across:
        return found
    c, s = direction_of(gear)
    return replace(found, speed=c * found.speed - s * across, left=s * found.speed + c * across)
