"""Legs of a path, driven one after the other: a turn on the spot if needed, then along the points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.planning.legs import Leg, bearing_of, legs_of_motions
from ur_nodes.navigation.planning.outline_motions import MotionPose
from ur_nodes.navigation.planning.path_geometry import Points, nearest_index
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import LocalCommand, follow_reference, sweep_is_free
from ur_nodes.navigation.steering.rollout import FollowSettings, ReferencePath, RolloutState, make_reference
from ur_nodes.navigation.steering.speed_profile import SpeedLimits, approach, speed_shares, turn_towards

_BACK = 0.2  # m/s, at most, while a leg is driven back
_ARRIVED = 0.015  # m from the end of a leg
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
        if leg.gear < 0:
            motion = RolloutState(motion.pose.compose(Pose2(0.0, 0.0, math.pi)), -motion.speed, motion.turn)
            driving = replace(
                driving,
                footprint=_turned_round(driving.footprint),
                limits=replace(driving.limits, speed=min(_BACK, driving.limits.speed)),
            )
        reference = self._refer(leg, odom, speed_mask, driving.limits)
        x, y = motion.pose.x, motion.pose.y
        last = min(self._index + _MOST_POINTS, reference.end + 1)
        self._index = nearest_index(reference.points, x, y, self._index, last)
        end_x, end_y = reference.points[reference.end].tolist()
        away = math.hypot(end_x - x, end_y - y)
        if self._index >= reference.end or away < _ARRIVED:
            resting = abs(motion.speed) < _STILL
            if self._number == len(self._legs) - 1:
                return LegStep(_brake(motion, driving, leg.gear), away, ended=True)
            if resting:
                self._number, self._index, self._reference = self._number + 1, 0, None
                self._aligned = self._legs[self._number].turned is None
            return LegStep(_brake(motion, driving, leg.gear), 0.0)
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
        return LegStep(found if leg.gear > 0 else replace(found, speed=-found.speed), astray)

    def _align(
        self, leg: Leg, motion: RolloutState, local: LocalObstacles, odom: Pose2, driving: Driving
    ) -> LocalCommand | None:
        """Turn on the spot until the robot points along a leg; None when it does."""
        error = wrap_angle(odom.yaw + bearing_of(leg) - motion.pose.yaw)
        if leg.turned is not None and abs(leg.turned) > _LONG_TURN and error * leg.turned < 0.0 and abs(error) > 0.3:
            error += math.copysign(math.tau, leg.turned)
        if abs(error) < _ALIGNED and abs(motion.speed) < _STILL and abs(motion.turn) < _SLOW_TURN:
            self._aligned = True
            return None
        limits, period = driving.limits, driving.period
        speed = approach(motion.speed, 0.0, limits.acceleration * period)
        turn = turn_towards(error, motion.turn, limits, period)
        here = np.array(motion.pose)[None]
        trial = RolloutState(motion.pose, 0.0, turn)
        if abs(turn) >= _STILL and not sweep_is_free(trial, 0.3, local, driving.footprint):
            turn = approach(motion.turn, 0.0, limits.turn_acceleration * period)
            return LocalCommand(speed, turn, here, blocked=True)
        return LocalCommand(speed, turn, here)

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


def legs_back(track: Sequence[Pose2], distance: float) -> tuple[Leg, ...]:
    """Return the legs that lead back along the poses of a track, oldest first, for at most `distance` m."""
    if len(track) < 2:
        return ()
    motions, length = [MotionPose(*track[-1], 0)], 0.0
    for here, before in zip(reversed(track), list(reversed(track))[1:], strict=False):
        dx, dy = before.x - here.x, before.y - here.y
        step = math.hypot(dx, dy)
        ahead = dx * math.cos(here.yaw) + dy * math.sin(here.yaw)
        gear = 0 if step < 0.01 else 1 if ahead > 0.0 else -1
        motions.append(MotionPose(*before, gear))
        length += step
        if length >= distance:
            break
    return legs_of_motions(motions)[0]


def _brake(motion: RolloutState, driving: Driving, gear: int) -> LocalCommand:
    limits, period = driving.limits, driving.period
    speed = approach(motion.speed, 0.0, limits.acceleration * period)
    turn = approach(motion.turn, 0.0, limits.turn_acceleration * period)
    return LocalCommand(gear * speed, turn, np.array(motion.pose)[None])


def _turned_round(footprint: Footprint) -> Footprint:
    """Return the outline of a robot that drives backwards."""
    return Footprint(-footprint.outline, footprint.inscribed, footprint.circumscribed, -footprint.samples)
