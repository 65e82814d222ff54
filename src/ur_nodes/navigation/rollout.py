"""Rollouts: a steering law that follows a path, simulated ahead for several variants at once as arrays.

Steering is pure pursuit (Coulter, Implementation of the pure pursuit path tracking algorithm, 1992): an arc to a point
of the path ahead. Far from its direction the robot turns on the spot, and near the end it brakes by the distance left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.path_geometry import Points, headings
from ur_nodes.navigation.speed_profile import Limits, speed_profile

Floats = NDArray[np.float64]

_BRAKING = 0.6  # of the acceleration: brakes so that a stop is reached without effort
_TURN_BRAKING = 0.7  # likewise, of turns on the spot
_LAST_POINTS = 8  # too coarse to stop by: there the distance itself counts
_SPARE_POINTS = 3  # beyond those that the robot can pass in a step, in the search for the nearest
_NEAREST_SQUARED = 1e-4  # m2: bounds the curvature to a point that the robot is on
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


@dataclass(frozen=True, slots=True, eq=False)
class ReferencePath:
    """A path to follow, in the frame of the local costmap.

    Points (n, 2) `spacing` m apart, speeds (n), unit normals (n, 2) to the left. Beyond index `end` it goes on
    straight, so that steering does not end before the goal; `course` is the direction there.
    """

    points: Points
    normals: Points
    speeds: Floats
    spacing: float
    end: int
    course: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Motion:
    """Pose and velocity of the robot: pose in the frame of the path, m/s, rad/s."""

    pose: Pose2
    speed: float
    turn: float


def make_reference(points: Points, limits: Limits, shares: Floats | None = None, overrun: float = 0.6) -> ReferencePath:
    """Make a path of evenly spaced points (n, 2), n >= 2; `shares` (n) of the speed limit are allowed at them."""
    spacing = float(np.hypot(*(points[1] - points[0])))
    angle = float(headings(points)[max(0, len(points) - 4)])
    extra = np.arange(1, math.ceil(overrun / max(spacing, 0.01)) + 1)[:, None] * spacing
    longer = np.concatenate((points, points[-1] + extra * (math.cos(angle), math.sin(angle))))
    angles = headings(longer)
    speeds = np.concatenate((speed_profile(points, limits, shares), np.zeros(len(extra))))
    normals = np.stack((-np.sin(angles), np.cos(angles)), axis=-1)
    return ReferencePath(longer, normals, speeds, spacing, len(points) - 1, (math.cos(angle), math.sin(angle)))


@dataclass(frozen=True, slots=True, eq=False)
class Rollout:
    """Per step and variant: poses (t, k, 3), speeds and turns (t, k), nearest points of the path (t, k)."""

    poses: Floats
    speeds: Floats
    turns: Floats
    indices: NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """The robot in each of k variants: place (m), yaw (rad), speed (m/s), turn (rad/s), nearest point of the path."""

    x: Floats
    y: Floats
    yaw: Floats
    speed: Floats
    turn: Floats
    near: NDArray[np.intp]


def roll_out(
    reference: ReferencePath,
    index: int,
    motion: Motion,
    variants: Floats,
    limits: Limits,
    settings: FollowSettings,
    period: float,
) -> Rollout:
    """Simulate k variants of the law (k, 2), each a share of the speed limit and an offset to the left (m).

    `index` is a point of the path near the robot. The first step lasts `period` s, each other one `settings.step`.
    """
    count, steps = len(variants), math.ceil(settings.horizon / settings.step)
    x, y, yaw = (np.full(count, value) for value in motion.pose)
    near = np.full(count, index, dtype=np.intp)
    state = _State(x, y, yaw, np.full(count, motion.speed), np.full(count, motion.turn), near)
    poses, speeds, turns = np.empty((steps, count, 3)), np.empty((steps, count)), np.empty((steps, count))
    indices = np.empty((steps, count), np.intp)
    window = np.arange(math.ceil(limits.speed * settings.step / reference.spacing) + _SPARE_POINTS)
    for number in range(steps):
        seconds = period if number == 0 else settings.step
        near = _nearest_points(reference, state, window)
        wanted, turning = _steer(reference, state, near, variants, limits, settings, seconds)
        state = _advance(state, near, wanted, turning, limits, seconds)
        poses[number, :, 0], poses[number, :, 1], poses[number, :, 2] = state.x, state.y, state.yaw
        speeds[number], turns[number], indices[number] = state.speed, state.turn, near
    return Rollout(poses, speeds, turns, indices)


def _nearest_points(reference: ReferencePath, state: _State, window: NDArray[np.intp]) -> NDArray[np.intp]:
    """The nearest points (k) of the path, among those `window` (w) on from the ones before."""
    around = np.minimum(state.near[:, None] + window, reference.end)
    gaps = reference.points[around] - np.stack((state.x, state.y), axis=-1)[:, None]
    nearest: NDArray[np.intp] = around[np.arange(len(around)), np.argmin((gaps**2).sum(axis=2), axis=1)]
    return nearest


def _steer(
    reference: ReferencePath,
    state: _State,
    near: NDArray[np.intp],
    variants: Floats,
    limits: Limits,
    settings: FollowSettings,
    seconds: float,
) -> tuple[Floats, Floats]:
    """The wanted speeds and turns (k) with the path's nearest points (k), for the next `seconds`."""
    v = state.speed
    ahead = np.clip(settings.preview * v, settings.preview_least, settings.preview_most)
    aim = np.minimum(near + np.rint(ahead / reference.spacing).astype(np.intp), len(reference.points) - 1)
    target = reference.points[aim] + variants[:, 1, None] * reference.normals[aim]
    dx, dy = target[:, 0] - state.x, target[:, 1] - state.y
    c, s = np.cos(state.yaw), np.sin(state.yaw)
    forward, left = c * dx + s * dy, c * dy - s * dx
    bearing = np.arctan2(left, forward)
    curvature = 2.0 * left / np.maximum(dx**2 + dy**2, _NEAREST_SQUARED)
    share = np.clip((settings.turn_first - np.abs(bearing)) / (settings.turn_first - settings.turn_some), 0.0, 1.0)
    soon = np.minimum(near + np.rint(v * seconds / reference.spacing).astype(np.intp), reference.end)
    allowed = np.minimum(variants[:, 0] * limits.speed, reference.speeds[soon])
    wanted = np.minimum(allowed, limits.turn / np.maximum(np.abs(curvature), _STRAIGHT)) * share
    end, course = reference.points[reference.end], reference.course
    left_over = (end[0] - state.x) * course[0] + (end[1] - state.y) * course[1] - settings.delay * v
    brake = np.sqrt(2.0 * _BRAKING * limits.acceleration * np.maximum(left_over, 0.0))
    wanted = np.where(near > reference.end - _LAST_POINTS, np.minimum(wanted, brake), wanted)
    most_spin = np.sqrt(2.0 * _TURN_BRAKING * limits.turn_acceleration * np.abs(bearing))
    spin = np.sign(bearing) * np.minimum(limits.turn, most_spin)
    turning = np.clip(wanted * curvature * share + (1.0 - share) * spin, -limits.turn, limits.turn)
    return wanted, turning


def _advance(
    state: _State, near: NDArray[np.intp], wanted: Floats, turning: Floats, limits: Limits, seconds: float
) -> _State:
    """Move for `seconds` with the wanted speeds and turns (k), as far as the accelerations allow."""
    shift, swing = limits.acceleration * seconds, limits.turn_acceleration * seconds
    v = np.minimum(state.speed + shift, np.maximum(state.speed - shift, wanted))
    w = np.minimum(state.turn + swing, np.maximum(state.turn - swing, turning))
    middle = state.yaw + 0.5 * w * seconds
    x, y = state.x + v * seconds * np.cos(middle), state.y + v * seconds * np.sin(middle)
    return _State(x, y, state.yaw + w * seconds, v, w, near)
