"""The next command: a steering law that follows the path, simulated ahead before its command is used.

The first choice is the plain law. Variants of it (slower, to the left or right of the path) matter only when its
footprint would touch something.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.people.tracked_people import approaches, hull_of_footprint, rooms_to
from ur_nodes.navigation.planning.outline_grid import overlaps
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.rollout import (
    FAST,
    Floats,
    FollowSettings,
    ReferencePath,
    RolloutState,
    horizon_at,
    roll_out,
)
from ur_nodes.navigation.steering.speed_profile import DriveVelocity, SpeedLimits, brake_for

# Variants of the steering law: the share of the speed limit, the offset to the left of the path (m).
_PLAIN = np.array(((1.0, 0.0),))
_VARIANTS = np.array([(s, o) for s in (0.7, 0.4, 0.2, 0.08, 0.0) for o in (0.0, 0.1, -0.1, 0.2, -0.2)])
_OFFSET_COST = 0.5  # m of progress that a metre beside the path costs
_LEAST_GAIN, _LEAST_TURN = 0.02, 0.05  # m, rad/s: a variant with less of both gets the robot nowhere
_BESIDE_POINTS = 0.015  # m between the outline and a point of the scan
_NO_NEARER = 0.002  # m
_SAMPLED = 0.1  # s between two poses of a sweep
_CAREFUL = 0.5  # m/s: of a fast base where it only just passes, since what steering is off by grows with the speed
_MARGIN = 0.05  # m of room that permit no more than that
_PER_METRE = 3.0  # m/s more for each metre of room


@dataclass(frozen=True, slots=True, eq=False)
class LocalCommand:
    """The next command: speed and turn, and m/s to the left. `ahead` (t, 3) are the poses that this leads to.

    `hindered`: an obstacle blocks the plain law, another variant was taken. `blocked`: every variant would
    touch something, the command is to stop. `waits`: without people the robot would drive on.
    """

    speed: float
    turn: float
    ahead: Floats
    hindered: bool = False
    blocked: bool = False
    waits: bool = False
    left: float = 0.0

    @property
    def velocity(self) -> DriveVelocity:
        """The velocity to send."""
        return DriveVelocity(self.speed, self.turn, self.left)


def follow_reference(
    reference: ReferencePath,
    index: int,
    motion: RolloutState,
    around: LocalObstacles,
    footprint: Footprint,
    limits: SpeedLimits,
    settings: FollowSettings,
    period: float,
) -> LocalCommand:
    """Return the next command for a robot near point `index` of the path; `period` is its duration (s).

    The command differs from the present motion by no more than the accelerations allow in `period`.
    """
    if limits.speed > FAST:
        reference = slow_beside(reference, index, around.costmap, footprint, limits)
        soon = abs(motion.speed) + limits.acceleration * period  # what a later one would touch, a later command avoids
        settings = replace(settings, horizon=min(settings.horizon, horizon_at(soon, limits, settings)))
    plain = roll_out(reference, index, motion, _PLAIN, limits, settings, period)
    times: Floats = period + settings.step * np.arange(len(plain.poses), dtype=np.float64)
    clear = not _touches(plain.poses, motion.pose, around, footprint)[:, 0].any()
    if clear and not approaches(plain.poses, times, motion.pose, around.people, footprint)[:, 0].any():
        return LocalCommand(float(plain.speeds[0, 0]), float(plain.turns[0, 0]), plain.poses[:, 0])
    others = roll_out(reference, index, motion, _VARIANTS, limits, settings, period)
    possible = ~_touches(others.poses, motion.pose, around, footprint).any(axis=0)
    free = possible & ~approaches(others.poses, times, motion.pose, around.people, footprint).any(axis=0)
    waits = bool((possible & ~free).any()) or clear
    gains = (others.indices[-1] - index) * reference.spacing - _OFFSET_COST * np.abs(_VARIANTS[:, 1])
    best = int(np.argmax(np.where(free, gains, -np.inf)))
    if not free.any() or (gains[best] <= _LEAST_GAIN and abs(others.turns[:, best]).max() < _LEAST_TURN):
        exact = around.exact()
        if exact is around:
            return _stop(motion, limits, settings, period, waits=waits)
        return follow_reference(reference, index, motion, exact, footprint, limits, settings, period)
    return LocalCommand(
        float(others.speeds[0, best]), float(others.turns[0, best]), others.poses[:, best], hindered=True
    )


def slow_beside(
    reference: ReferencePath, index: int, costmap: Costmap, footprint: Footprint, limits: SpeedLimits
) -> ReferencePath:
    """Return the path with lower speeds beside obstacles, from point `index` on as far as the costmap reaches."""
    reach = math.ceil(0.5 * math.hypot(*costmap.shape) * costmap.resolution / reference.spacing)
    part = slice(index, min(index + reach, reference.end + 1))
    if part.stop <= part.start or not (costmap.costs == LETHAL).any():
        return reference
    distances = distance_transform_edt(costmap.costs != LETHAL) * costmap.resolution
    rows, columns = costmap.cells_of_points(reference.points[part]).T
    height, width = costmap.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    room = np.full(len(rows), np.inf)
    room[inside] = distances[rows[inside], columns[inside]] - footprint.inscribed - _MARGIN
    allowed = _CAREFUL + _PER_METRE * np.maximum(0.0, room)
    speeds = reference.speeds.copy()
    speeds[part] = np.minimum(speeds[part], allowed)
    speeds[: part.stop] = brake_for(speeds[: part.stop], reference.spacing, limits)
    return replace(reference, speeds=speeds)


def sweep_is_free(motion: RolloutState, seconds: float, around: LocalObstacles, footprint: Footprint) -> bool:
    """Return True when keeping the velocity for a while touches nothing (more than the robot does already)."""
    times = np.linspace(0.0, seconds, max(2, math.ceil(seconds / _SAMPLED) + 1))
    yaws = motion.pose.yaw + motion.turn * times
    steps = np.diff(times, prepend=0.0)
    ahead, aside, cosines, sines = steps * motion.speed, steps * motion.left, np.cos(yaws), np.sin(yaws)
    xs = motion.pose.x + np.cumsum(ahead * cosines - aside * sines)
    ys = motion.pose.y + np.cumsum(ahead * sines + aside * cosines)
    poses = np.stack((xs, ys, yaws), axis=-1)[:, None]
    if approaches(poses, times, motion.pose, around.people, footprint).any():
        return False
    if not _touches(poses, motion.pose, around, footprint).any():
        return True
    exact = around.exact()
    return exact is not around and not _touches(poses, motion.pose, exact, footprint).any()


def _touches(poses: Floats, start: Pose2, around: LocalObstacles, footprint: Footprint) -> NDArray[np.bool_]:
    """Mark the poses (t, k, 3) that put more of the footprint on obstacles than there is of it already at `start`.

    So a robot that something has come too near to may still move away. What lies beyond the costmap counts as free.
    """
    here, costmap = np.array(start), around.costmap
    touching: NDArray[np.bool_] = overlaps(poses, costmap, footprint) > overlaps(here, costmap, footprint)
    if len(around.points):
        touching |= _meets_points(poses, here, around.points, footprint)
    return touching


def _meets_points(poses: Floats, start: Floats, points: Floats, footprint: Footprint) -> NDArray[np.bool_]:
    """Mark the poses (t, k, 3) that bring a point nearer to the outline than it may be, or is already at `start`."""
    reach = footprint.circumscribed + float(np.hypot(*np.moveaxis(poses[..., :2] - start[:2], -1, 0)).max())
    points = points[np.hypot(*(points - start[:2]).T) < reach + _BESIDE_POINTS]
    hull = hull_of_footprint(footprint)
    if not len(points):
        return np.zeros(poses.shape[:2], bool)
    rooms = rooms_to(hull, poses, points)
    least = np.minimum(_BESIDE_POINTS, rooms_to(hull, start, points) - _NO_NEARER)
    return np.asarray((rooms < least).any(axis=-1))


def _stop(
    motion: RolloutState, limits: SpeedLimits, settings: FollowSettings, period: float, *, waits: bool
) -> LocalCommand:
    speed = max(0.0, motion.speed - limits.acceleration * period) if motion.speed > 0 else 0.0
    turn = math.copysign(max(0.0, abs(motion.turn) - limits.turn_acceleration * period), motion.turn)
    here = np.array(motion.pose)[None]
    ahead = np.repeat(here, math.ceil(settings.horizon / settings.step), axis=0)
    return LocalCommand(speed, turn, ahead, blocked=True, waits=waits)
