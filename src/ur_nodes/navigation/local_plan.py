"""The next command: a steering law follows the path, and is simulated ahead before its command is used.

Several variants of the law (slower, to the left or right of the path) are rolled out together as arrays; the first
choice is the plain one, and the others matter only when its footprint would touch something.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.path_geometry import Points, headings
from ur_nodes.navigation.speed_profile import Limits, speed_profile

Floats = NDArray[np.float64]


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


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """The next command: speed (m/s) and turn (rad/s). `ahead` (t, 3) are the poses that this leads to.

    `hindered`: an obstacle blocks the plain law, another variant was taken. `blocked`: every variant would
    touch something, the command is to stop.
    """

    speed: float
    turn: float
    ahead: Floats
    hindered: bool = False
    blocked: bool = False


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


def follow_reference(
    reference: ReferencePath,
    index: int,
    motion: Motion,
    costmap: Costmap,
    footprint: Footprint,
    limits: Limits,
    settings: FollowSettings,
    period: float,
) -> Step:
    """Return the next command for a robot near point `index` of the path; `period` is its duration (s).

    The command differs from the present motion by no more than the accelerations allow in `period`.
    """
    plain = _roll(reference, index, motion, _PLAIN, limits, settings, period)
    if not _touches(plain.poses, motion.pose, costmap, footprint)[:, 0].any():
        return Step(float(plain.speeds[0, 0]), float(plain.turns[0, 0]), plain.poses[:, 0])
    others = _roll(reference, index, motion, _VARIANTS, limits, settings, period)
    touching = _touches(others.poses, motion.pose, costmap, footprint)
    free = ~touching.any(axis=0)
    if not free.any():
        return _stop(motion, limits, settings, period)
    gains = (others.indices[-1] - index) * reference.spacing - 0.5 * np.abs(_VARIANTS[:, 1])
    best = int(np.argmax(np.where(free, gains, -np.inf)))
    if gains[best] <= 0.02 and abs(others.turns[:, best]).max() < 0.05:
        return _stop(motion, limits, settings, period)
    return Step(float(others.speeds[0, best]), float(others.turns[0, best]), others.poses[:, best], hindered=True)


def sweep_is_free(motion: Motion, seconds: float, costmap: Costmap, footprint: Footprint) -> bool:
    """Return True when keeping the speed and turn for a while touches nothing (more than the robot does already)."""
    times = np.linspace(0.0, seconds, max(2, math.ceil(seconds / 0.1) + 1))
    yaws = motion.pose.yaw + motion.turn * times
    steps = np.diff(times, prepend=0.0) * motion.speed
    xs = motion.pose.x + np.cumsum(steps * np.cos(yaws))
    ys = motion.pose.y + np.cumsum(steps * np.sin(yaws))
    return not bool(_touches(np.stack((xs, ys, yaws), axis=-1)[:, None], motion.pose, costmap, footprint).any())


# Variants of the steering law: the share of the speed limit, the offset to the left of the path (m).
_PLAIN = np.array(((1.0, 0.0),))
_VARIANTS = np.array([(s, o) for s in (0.7, 0.4, 0.2, 0.08, 0.0) for o in (0.0, 0.1, -0.1, 0.2, -0.2)])


@dataclass(frozen=True, slots=True, eq=False)
class _Rollout:
    """Per step and variant: poses (t, k, 3), speeds and turns (t, k), nearest points of the path (t, k)."""

    poses: Floats
    speeds: Floats
    turns: Floats
    indices: NDArray[np.intp]


def _roll(
    reference: ReferencePath,
    index: int,
    motion: Motion,
    variants: Floats,
    limits: Limits,
    settings: FollowSettings,
    period: float,
) -> _Rollout:
    count, steps = len(variants), math.ceil(settings.horizon / settings.step)
    caps, offsets = variants[:, 0] * limits.speed, variants[:, 1, None]
    x, y, yaw = (np.full(count, value) for value in motion.pose)
    v, w = np.full(count, motion.speed), np.full(count, motion.turn)
    near = np.full(count, index, dtype=np.intp)
    poses, speeds, turns = np.empty((steps, count, 3)), np.empty((steps, count)), np.empty((steps, count))
    indices = np.empty((steps, count), np.intp)
    reach = math.ceil(limits.speed * settings.step / reference.spacing) + 3
    window = np.arange(reach)
    last = len(reference.points) - 1
    for number in range(steps):
        dt = period if number == 0 else settings.step
        around = np.minimum(near[:, None] + window, reference.end)
        gaps = reference.points[around] - np.stack((x, y), axis=-1)[:, None]
        near = around[np.arange(count), np.argmin((gaps**2).sum(axis=2), axis=1)]
        ahead = np.clip(settings.preview * v, settings.preview_least, settings.preview_most)
        aim = np.minimum(near + np.rint(ahead / reference.spacing).astype(np.intp), last)
        target = reference.points[aim] + offsets * reference.normals[aim]
        dx, dy = target[:, 0] - x, target[:, 1] - y
        c, s = np.cos(yaw), np.sin(yaw)
        forward, left = c * dx + s * dy, c * dy - s * dx
        bearing = np.arctan2(left, forward)
        bend = 2.0 * left / np.maximum(dx**2 + dy**2, 1e-4)
        share = np.clip((settings.turn_first - np.abs(bearing)) / (settings.turn_first - settings.turn_some), 0.0, 1.0)
        soon = np.minimum(near + np.rint(v * dt / reference.spacing).astype(np.intp), reference.end)
        wanted = (
            np.minimum(np.minimum(caps, reference.speeds[soon]), limits.turn / np.maximum(np.abs(bend), 1e-6)) * share
        )
        # The last points are too coarse to stop by: there the distance itself counts, less what a late command costs.
        left_over = (reference.points[reference.end, 0] - x) * reference.course[0] + (
            reference.points[reference.end, 1] - y
        ) * reference.course[1]
        brake = np.sqrt(1.2 * limits.acceleration * np.maximum(left_over - settings.delay * v, 0.0))
        wanted = np.where(near > reference.end - 8, np.minimum(wanted, brake), wanted)
        spin = np.sign(bearing) * np.minimum(limits.turn, np.sqrt(1.4 * limits.turn_acceleration * np.abs(bearing)))
        turning = np.clip(wanted * bend * share + (1.0 - share) * spin, -limits.turn, limits.turn)
        v = np.minimum(v + limits.acceleration * dt, np.maximum(v - limits.acceleration * dt, wanted))
        w = np.minimum(w + limits.turn_acceleration * dt, np.maximum(w - limits.turn_acceleration * dt, turning))
        middle = yaw + 0.5 * w * dt
        x, y, yaw = x + v * dt * np.cos(middle), y + v * dt * np.sin(middle), yaw + w * dt
        poses[number, :, 0], poses[number, :, 1], poses[number, :, 2] = x, y, yaw
        speeds[number], turns[number], indices[number] = v, w, near
    return _Rollout(poses, speeds, turns, indices)


def _touches(poses: Floats, start: Pose2, costmap: Costmap, footprint: Footprint) -> NDArray[np.bool_]:
    """Mark the poses (t, k, 3) that put more of the footprint on obstacles than there is of it already at `start`.

    So a robot that something has come too near to may still move away. What lies beyond the costmap counts as free.
    """
    deeper: NDArray[np.bool_] = _overlaps(poses, costmap, footprint) > _overlaps(np.array(start), costmap, footprint)
    return deeper


def _overlaps(poses: Floats, costmap: Costmap, footprint: Footprint) -> NDArray[np.intp]:
    """Count the samples of the footprint that lie on obstacles at each pose (..., 3)."""
    c, s = np.cos(poses[..., 2, None]), np.sin(poses[..., 2, None])
    fx, fy = footprint.samples.T
    points = np.stack((poses[..., 0, None] + c * fx - s * fy, poses[..., 1, None] + s * fx + c * fy), axis=-1)
    counts: NDArray[np.intp] = (costmap.costs_at(points, outside=FREE) == LETHAL).sum(axis=-1)
    return counts


def _stop(motion: Motion, limits: Limits, settings: FollowSettings, period: float) -> Step:
    speed = max(0.0, motion.speed - limits.acceleration * period) if motion.speed > 0 else 0.0
    turn = math.copysign(max(0.0, abs(motion.turn) - limits.turn_acceleration * period), motion.turn)
    here = np.array(motion.pose)[None]
    return Step(speed, turn, np.repeat(here, math.ceil(settings.horizon / settings.step), axis=0), blocked=True)
