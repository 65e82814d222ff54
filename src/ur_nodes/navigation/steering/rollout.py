"""Rollouts: a steering law that follows a path, simulated ahead for several variants.

Steering is pure pursuit (Coulter, Implementation of the pure pursuit path tracking algorithm, 1992): an arc to a point
of the path ahead. Far from its direction the robot turns on the spot, and near the end it brakes by the distance left.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.planning.path_geometry import Points, headings
from ur_nodes.navigation.steering.speed_profile import DriveVelocity, SpeedLimits, speed_profile

Floats = NDArray[np.float64]

FAST = 0.6
"""m/s: bases that drive no faster keep the margin of their footprint at any speed, and steer as they always have."""
_BRAKING = 0.6  # of the acceleration: brakes so that a stop is reached without effort
_STOPPING = 0.75  # likewise, at the end of the path
_TURN_BRAKING = 0.7  # likewise, of turns on the spot
_LAST_POINTS = 8  # too coarse to stop by: there the distance itself counts
_SPARE_POINTS = 3  # beyond those that the robot can pass in a step, in the search for the nearest
_NEAREST_SQUARED = 1e-4  # m2: bounds the curvature to a point that the robot is on
_OVERRUN = 0.6  # m: a path is extended beyond its end for predictions
_LAST_BEND = 4  # points at the end of a path, with whose bend it goes on
_NEAR_END = 0.12  # m: distance of the steering point beyond the end of a path
_STRAIGHT = 1e-6  # 1/m: smaller curvatures limit no speed


@dataclass(frozen=True, slots=True)
class FollowSettings:
    """Parameters of path following.

    `horizon` and `step` of the rollouts in s; `preview` (s) is the distance of the steering point ahead, within bounds
    (m); beyond a bearing of `turn_first` (rad) to it the robot only turns, from `turn_some` on it slows down;
    `delay` (s) is how late a command takes effect.
    """

    horizon: float = 1.6
    step: float = 0.1
    preview: float = 0.7
    preview_least: float = 0.22
    preview_most: float = 0.45
    delay: float = 0.05
    turn_some: float = 0.5
    turn_first: float = 1.3


def follow_settings(limits: SpeedLimits) -> FollowSettings:
    """Return the parameters for a base: rollouts last until it has braked, and a fast one steers further ahead."""
    usual = FollowSettings()
    speed = max(limits.speed, limits.lateral)
    far = replace(usual, preview_most=max(usual.preview_most, usual.preview * speed))
    return replace(far, horizon=horizon_at(speed, limits, far))


def horizon_at(speed: float, limits: SpeedLimits, settings: FollowSettings) -> float:
    """Return how long (s) a rollout lasts that shows whether the robot can brake in time from a speed."""
    return max(FollowSettings().horizon, settings.delay + speed / (_BRAKING * limits.acceleration))


@dataclass(frozen=True, slots=True, eq=False)
class ReferencePath:
    """A path to follow, in the frame of the local costmap.

    Points (n, 2) `spacing` m apart, speeds (n), unit normals (n, 2) to the left. Beyond index `end` it goes on
    as it bends there, so that steering does not end before the goal; `course` is the direction there.
    """

    points: Points
    normals: Points
    speeds: Floats
    spacing: float
    end: int
    course: tuple[float, float]


@dataclass(frozen=True, slots=True)
class RolloutState:
    """Pose and velocity of the robot: pose in the frame of the path, m/s, rad/s, m/s to the left."""

    pose: Pose2
    speed: float
    turn: float
    left: float = 0.0

    @property
    def velocity(self) -> DriveVelocity:
        """Its velocity."""
        return DriveVelocity(self.speed, self.turn, self.left)


def make_reference(
    points: Points, limits: SpeedLimits, shares: Floats | None = None, course: float | None = None
) -> ReferencePath:
    """Make a path of evenly spaced points (n, 2), n >= 2; `shares` (n) of the speed limit are allowed at them.

    `course` is the direction at its end (rad), None: that of its last points.
    """
    spacing = float(np.hypot(*(points[1] - points[0])))
    angle, bend = (0.0 if course is None else course), 0.0
    if course is None:
        last = headings(points)[-_LAST_BEND - 1 :]
        bend = wrap_angle(float(last[-2] - last[0])) / max(1, len(last) - 2) if len(last) > 1 else 0.0
        angle = float(last[-1]) + 0.5 * bend
    count = math.ceil(_OVERRUN / max(spacing, 0.01))
    onward = angle + bend * (np.arange(count) + 0.5)
    extra = spacing * np.cumsum(np.stack((np.cos(onward), np.sin(onward)), axis=-1), axis=0)
    longer = np.concatenate((points, points[-1] + extra))
    angles = headings(longer)
    speeds = np.concatenate((speed_profile(points, limits, shares), np.zeros(count)))
    normals = np.stack((-np.sin(angles), np.cos(angles)), axis=-1)
    return ReferencePath(longer, normals, speeds, spacing, len(points) - 1, (math.cos(angle), math.sin(angle)))


@dataclass(frozen=True, slots=True, eq=False)
class Rollout:
    """Per step and variant: poses (t, k, 3), speeds and turns (t, k), nearest points of the path (t, k)."""

    poses: Floats
    speeds: Floats
    turns: Floats
    indices: NDArray[np.intp]


class _State(NamedTuple):
    """The robot in one variant: place (m), yaw (rad), speed (m/s), turn (rad/s), nearest point of the path."""

    x: float
    y: float
    yaw: float
    speed: float
    turn: float
    near: int


class _Course:
    """The part of a reference path that a rollout can reach as numbers: it takes them one by one.

    `points` and `normals` begin with that of index `first`.
    """

    def __init__(self, reference: ReferencePath, index: int, reach: int) -> None:
        self.first = min(index, reference.end)
        part = slice(self.first, self.first + reach)
        self.points: list[list[float]] = reference.points[part].tolist()
        self.normals: list[list[float]] = reference.normals[part].tolist()
        self.speeds: list[float] = reference.speeds.tolist()
        self.spacing, self.last = reference.spacing, len(reference.points) - 1
        self.end, self.direction = reference.end, reference.course
        self.end_x, self.end_y = reference.points[reference.end].tolist()


def roll_out(
    reference: ReferencePath,
    index: int,
    motion: RolloutState,
    variants: Floats,
    limits: SpeedLimits,
    settings: FollowSettings,
    period: float,
) -> Rollout:
    """Simulate k variants of the law (k, 2), each a share of the speed limit and an offset to the left (m).

    `index` is a point of the path near the robot. The first step lasts `period` s, each other one `settings.step`.
    """
    seconds = [period] + [settings.step] * (math.ceil(settings.horizon / settings.step) - 1)
    window = math.ceil(limits.speed * settings.step / reference.spacing) + _SPARE_POINTS
    ahead = math.ceil(settings.preview_most / reference.spacing)
    course = _Course(reference, index, len(seconds) * window + ahead + 1)
    start = _State(*motion.pose, motion.speed, motion.turn, index)
    states = []
    for share, offset in variants.tolist():
        state, along = start, []
        for each in seconds:
            near = _nearest_point(course, state, window)
            wanted, turning = _steer(course, state, near, (share, offset), limits, settings, each)
            state = _advance(state, near, wanted, turning, limits, each)
            along.append(state)
        states.append(along)
    result = np.array(states).swapaxes(0, 1)
    return Rollout(result[..., :3], result[..., 3], result[..., 4], result[..., 5].astype(np.intp))


def _nearest_point(course: _Course, state: _State, window: int) -> int:
    """The nearest point of the path, among as many from the one before on."""
    best, least = state.near, math.inf
    for number in range(state.near, min(state.near + window, course.end + 1)):
        x, y = course.points[number - course.first]
        gap = (x - state.x) * (x - state.x) + (y - state.y) * (y - state.y)
        if gap < least:
            best, least = number, gap
    return min(best, course.end)


def _steer(
    course: _Course,
    state: _State,
    near: int,
    variant: tuple[float, float],
    limits: SpeedLimits,
    settings: FollowSettings,
    seconds: float,
) -> tuple[float, float]:
    """Return the requested speed and turn with the path's nearest point, for the next `seconds`."""
    v = state.speed
    ahead = min(max(settings.preview * v, settings.preview_least), settings.preview_most)
    beyond = max(near + round(_NEAR_END / course.spacing), course.end)  # not far: it would cut the bend at the end
    aim = min(near + round(ahead / course.spacing), beyond, course.last) - course.first
    (x, y), (across, along) = course.points[aim], course.normals[aim]
    dx, dy = x + variant[1] * across - state.x, y + variant[1] * along - state.y
    c, s = math.cos(state.yaw), math.sin(state.yaw)
    forward, left = c * dx + s * dy, c * dy - s * dx
    bearing = math.atan2(left, forward)
    curvature = 2.0 * left / max(dx * dx + dy * dy, _NEAREST_SQUARED)
    share = min(max((settings.turn_first - abs(bearing)) / (settings.turn_first - settings.turn_some), 0.0), 1.0)
    if limits.radius:  # it cannot turn first
        share, curvature = 1.0, min(max(curvature, -1.0 / limits.radius), 1.0 / limits.radius)
    soon = min(near + round(v * seconds / course.spacing), course.end)
    allowed = min(variant[0] * limits.speed, course.speeds[soon])
    spin = min(limits.turn, math.sqrt(2.0 * _TURN_BRAKING * limits.turn_acceleration * abs(bearing)))
    # A fast base that turns more than it can end at the bearing weaves.
    swing = spin if limits.speed > FAST and not limits.radius else limits.turn
    wanted = share * (min(allowed, swing / abs(curvature)) if abs(curvature) > _STRAIGHT else allowed)
    if near > course.end - _LAST_POINTS:
        (c, s), x, y = course.direction, course.end_x - state.x, course.end_y - state.y
        left_over = x * c + y * s - settings.delay * v
        wanted = min(wanted, math.sqrt(2.0 * _STOPPING * limits.acceleration * max(left_over, 0.0)))
    turning = wanted * curvature * share + (1.0 - share) * math.copysign(spin, bearing)
    return wanted, min(max(turning, -limits.turn), limits.turn)


def _advance(state: _State, near: int, wanted: float, turning: float, limits: SpeedLimits, seconds: float) -> _State:
    """Move for `seconds` with the requested speed and turn, within the accelerations."""
    shift, swing = limits.acceleration * seconds, limits.turn_acceleration * seconds
    v = min(max(wanted, state.speed - shift), state.speed + shift)
    w = limits.turn_at(v, min(max(turning, state.turn - swing), state.turn + swing))
    middle = state.yaw + 0.5 * w * seconds
    x, y = state.x + v * seconds * math.cos(middle), state.y + v * seconds * math.sin(middle)
    return _State(x, y, state.yaw + w * seconds, v, w, near)
