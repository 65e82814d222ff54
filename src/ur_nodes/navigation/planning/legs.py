"""Paths as legs: each is driven ahead or back, some after a turn on the spot."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.navigation.planning.outline_motions import MotionPose, course_of
from ur_nodes.navigation.planning.path_geometry import Points, resample

_SHORTEST = 0.02  # m: of a leg
_SPACING = 0.05  # m
_SAME_COURSE = 0.06  # rad: a turn on the spot by less is left to steering


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """Points (n, 2) in m, n >= 2, evenly apart, driven ahead (`gear` 1), back (-1), to the left or to the right.

    Where `turned` is not None, the robot first turns on the spot, by about so much (rad, left is positive), so that the
    gear leads along the leg. `course` is the direction of motion at its end (rad), None for a path that was not made
    for the outline, where it need not be exact.
    """

    points: Points
    gear: int = 1
    turned: float | None = None
    course: float | None = None


def legs_of_motions(motions: Sequence[MotionPose]) -> tuple[tuple[Leg, ...], float]:
    """The legs of motions in order, and the turn (rad) on the spot at their end."""
    legs: list[Leg] = []
    turned, places, gear = 0.0, [motions[0]], 0
    for before, motion in pairwise(motions):
        if motion.gear == 0 or motion.gear != gear:
            turned = _close(legs, places, gear, turned)
            places, gear = [before], motion.gear
        if motion.gear == 0:
            turned += wrap_angle(motion.yaw - before.yaw)
            places = [motion]
        else:
            places.append(motion)
    left = _close(legs, places, gear, turned)
    return tuple(legs), left


def _close(legs: list[Leg], places: list[MotionPose], gear: int, turned: float) -> float:
    """Add a leg if it has a length. Returns the turn that is left for the next one."""
    if gear == 0 or len(places) < 2:
        return turned
    points = np.array([place[:2] for place in places])
    if np.hypot(*np.diff(points, axis=0).T).sum() < _SHORTEST:
        return turned
    exact = abs(turned) > _SAME_COURSE or (bool(legs) and legs[-1].gear != gear)
    course = wrap_angle(places[-1].yaw + course_of(gear))
    legs.append(Leg(resample(points, _SPACING), gear, turned if exact else None, course))
    return 0.0


def points_of_legs(legs: Sequence[Leg]) -> Points:
    """All points (n, 2) in order."""
    return np.concatenate([leg.points for leg in legs])


def bearing_of(leg: Leg) -> float:
    """The heading of a robot at the begin of a leg, rad."""
    ahead = leg.points[min(2, len(leg.points) - 1)] - leg.points[0]
    bearing = math.atan2(float(ahead[1]), float(ahead[0]))
    return wrap_angle(bearing - course_of(leg.gear))
