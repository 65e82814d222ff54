"""The permitted velocity before obstacles that a base's sensors see, as a pure function of sight, velocity and time.

The outline is swept along the arc of the velocity. With `t` the time until it meets a point, `reaction` the time until
the wheels obey, and `b` the time that braking takes, the share k of the velocity is permitted that solves

    k * reaction + k^2 * b / 2 = t

so the base can always stop on its arc, `MARGIN` before what it sees. The braking is gentler than the base's limits;
what is left is a reserve. A motion that increases the distance from what is near is always permitted. Where the margin
leaves no motion, a slow one is permitted along what is nearer (`CREEP`), and a turn without the way forward.

What no sensor sees is taken for neither free nor blocked: towards it the base drives at most `BLIND`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur.robot.base import MotionLimits
from ur_nodes.geometry.hull import Hull
from ur_nodes.motion.obstacle_stop.sensors import Side, covers
from ur_nodes.motion.obstacle_stop.sight import Sight

Floats = NDArray[np.float64]

_STRAIGHT = 1e-6  # rad/s: slower turns are none
_LEAST = 1e-4  # m: a motion that brings a touched point nearer than this meets it
_ROUNDING = 1e-9


def time_to_contact(
    hull: Hull, points: Floats, margin: float, velocity: tuple[float, float], horizon: float, left: float = 0.0
) -> tuple[float, int]:
    """The time (s) until the outline, `margin` (m) wider, meets the first of some points (n, 2), and which one.

    Infinite, and -1, when it meets none within `horizon` s of driving with `velocity` (forward, turn) and to the
    `left` (m/s). A point that is
    nearer than the margin already is met at once by a motion that brings it nearer, and never by one that does not.
    """
    forward, turn = velocity
    margins = np.minimum(margin, hull.distances(points) - _LEAST) if len(points) else np.empty(0)
    if not len(points):
        return math.inf, -1
    times = _arc(hull, points, margins, (forward, left), turn, horizon) if abs(turn) > _STRAIGHT else None
    if times is None:
        times = _straight(hull, points, margins, (forward, left))
    first = int(np.argmin(times))
    return (float(times[first]), first) if times[first] <= horizon else (math.inf, -1)


def _straight(hull: Hull, points: Floats, margins: Floats, along: tuple[float, float]) -> Floats:
    """Return times (n) for straight motion: the interval in which a point is within the half-planes of all edges."""
    outside = points @ hull.normals.T - hull.offsets - margins[:, None]  # (n, edges)
    rates = -along[0] * hull.normals[:, 0]
    if along[1]:
        rates = rates - along[1] * hull.normals[:, 1]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        crossings = -outside / rates
    enters = np.where(rates < -_ROUNDING, crossings, -np.inf).max(axis=1)
    leaves = np.where(rates > _ROUNDING, crossings, np.inf).min(axis=1)
    beside = ((np.abs(rates) <= _ROUNDING) & (outside > 0.0)).any(axis=1)
    times: Floats = np.where(~beside & (enters <= leaves) & (enters >= 0.0), enters, np.inf)
    return times


def _arc(
    hull: Hull, points: Floats, margins: Floats, along: tuple[float, float], turn: float, horizon: float
) -> Floats:
    """Return times (n) for an arc: in the robot's frame, each point moves on a circle about the centre of the arc."""
    centre = np.array((-along[1] / turn, along[0] / turn))
    spokes = points - centre
    radii = np.hypot(*spokes.T)[:, None]
    phases = np.arctan2(
        spokes[:, 1, None] * hull.normals[:, 0] - spokes[:, 0, None] * hull.normals[:, 1], spokes @ hull.normals.T
    )  # (n, edges): the distance to an edge is radius * cos(angle - phase) + base
    base = hull.normals @ centre - hull.offsets
    bounds = margins[:, None] - base  # (n, edges)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = bounds / radii
        angles = math.copysign(1.0, turn) * phases + np.arccos(ratios)  # nan: this edge is never crossed
    times = (angles % (2.0 * math.pi)) / abs(turn)
    rows, columns = np.nonzero(times <= horizon)  # false for nan
    at = turn * times[rows, columns]
    meets = (radii[rows] * np.cos(at[:, None] - phases[rows]) <= bounds[rows] + _ROUNDING).all(axis=1)
    first = np.full(len(points), np.inf)
    np.minimum.at(first, rows[meets], times[rows, columns][meets])
    return first


MARGIN = 0.03  # m
_SCRAPE = 0.005  # m: while creeping
CREEP = 0.1  # m/s of the fastest point of the outline
BLIND = 0.2  # m/s
SILENT = 0.5  # s without a reading: a sensor sees nothing any more
_PERIODS = 2.5  # likewise, where that is longer
_GENTLE, _GENTLE_TURN = 1.0, 3.0  # m/s^2, rad/s^2: the braking that is planned, where the base can brake so hard
_PERIOD = 0.02  # s from one output of the mux to the next
_STILL = 0.01  # m/s of the fastest point: less is a stop
_TURN_ONLY = 0.02  # m/s: with less left of the way forward the turn is tried alone

Kind = Literal["obstacle", "bumper", "cliff", "unseen", "silent"]


@dataclass(frozen=True, slots=True)
class Cause:
    """The reason for a reduced velocity: the side of the base, and the distance (m) from the outline; inf if unknown.

    `name` is that of a bumper, a cliff sensor or a silent sensor, whose last reading is `age` s old.
    """

    kind: Kind
    side: Side
    distance: float = math.inf
    name: str = ""
    age: float = 0.0


@dataclass(frozen=True, slots=True)
class GuardVerdict:
    """The permitted velocity, m/s and rad/s, and the reason if it is less than the requested one."""

    forward: float
    turn: float
    cause: Cause | None = None
    left: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Guard:
    """A sight and the limits of the base: `braking` (m/s^2, rad/s^2) as planned, and `lag` (s) from mux to wheels."""

    sight: Sight
    braking: tuple[float, float]
    lag: float

    def permit(self, forward: float, turn: float, now: float, left: float = 0.0) -> GuardVerdict:
        """Return the velocity to send at `now` (s) in place of a requested one, on the same arc.

        `left` is the speed to the left, m/s.
        """
        sight = self.sight
        slower, cause = 1.0, None
        for side, speed in _sides_of(forward, left):
            if sight.sensors and speed * slower > BLIND and (unseen := self._look_for(side, now)):
                slower, cause = BLIND / speed, unseen
        forward, turn, left = slower * forward, slower * turn, slower * left
        points = sight.points_at(now)
        touched = list(sight.touched.values())
        everything = np.concatenate((points, *touched)) if touched else points
        if not len(everything):
            return GuardVerdict(forward, turn, cause, left)
        share, index = self._sweep(everything, forward, turn, now, left)
        if share >= 1.0:
            return GuardVerdict(forward, turn, cause, left)
        cause = self._describe(everything[index], index - len(points))
        speed = math.hypot(forward, left)
        if turn and speed and share * speed < _TURN_ONLY:
            alone, _ = self._sweep(everything, 0.0, turn, now)
            if alone > share:
                return GuardVerdict(0.0, alone * turn, cause)
        return GuardVerdict(share * forward, share * turn, cause, share * left)

    def _sweep(self, points: Floats, forward: float, turn: float, now: float, left: float = 0.0) -> tuple[float, int]:
        """Return the permitted share (0 to 1) of a velocity, and the index of the point that limits it; -1 for none."""
        hull = self.sight.hull
        reaction = self.lag + _PERIOD + self._age(now)
        speed = math.hypot(forward, left)
        braking = max(speed / self.braking[0], abs(turn) / self.braking[1])
        fastest = speed + abs(turn) * hull.radius
        if fastest <= 0.0:
            return 1.0, -1
        horizon = reaction + braking / 2.0
        within = np.hypot(*points.T) <= hull.radius + MARGIN + speed * horizon
        near = np.nonzero(within)[0]
        time, first = time_to_contact(hull, points[near], MARGIN, (forward, turn), horizon, left)
        share = _share(time, reaction, braking)
        if first < 0:
            return 1.0, -1
        if share * fastest < CREEP:
            longer = horizon + MARGIN / fastest
            time, _ = time_to_contact(hull, points[near], _SCRAPE, (forward, turn), longer, left)
            slow = _share(time - (MARGIN - _SCRAPE) / fastest, reaction, braking)
            share = max(share, min(slow, CREEP / fastest))
        return (share if share * fastest >= _STILL else 0.0), int(near[first])

    def _age(self, now: float) -> float:
        """Return the age (s) of the oldest reading of a live sensor, on which a decision may be based."""
        sight = self.sight
        ages = [max(sensor.period, sight.age(sensor, now)) for sensor in sight.sensors]
        return min(SILENT, max((age for age in ages if age <= SILENT), default=0.0))

    def _look_for(self, side: Side, now: float) -> Cause | None:
        """Return the reason why no live sensor sees all of a side; None if all is seen."""
        ages = {each: self.sight.age(each, now) for each in self.sight.sensors}
        live = tuple(each for each, age in ages.items() if age <= max(SILENT, _PERIODS * each.period))
        if covers(live, side):
            return None
        if len(live) < len(ages) and covers(self.sight.sensors, side):
            sensor, age = max((pair for pair in ages.items() if pair[0] not in live), key=lambda pair: pair[1])
            return Cause("silent", side, name=sensor.label, age=age)
        return Cause("unseen", side)

    def _describe(self, point: Floats, touched: int) -> Cause:
        hull = self.sight.hull
        side = side_of(hull, point)
        if touched < 0:
            return Cause("obstacle", side, max(0.0, float(hull.distances(point[None])[0])))
        for (kind, name), points in self.sight.touched.items():
            if touched < len(points):
                return Cause(kind, side, 0.0, name)
            touched -= len(points)
        return Cause("bumper", side, 0.0)


def _sides_of(forward: float, left: float) -> Iterator[tuple[Side, float]]:
    """The sides towards which a base moves, and how fast (m/s)."""
    if forward:
        yield ("ahead" if forward > 0.0 else "behind"), abs(forward)
    if left:
        yield ("on the left" if left > 0.0 else "on the right"), abs(left)


def make_guard(sight: Sight, limits: MotionLimits, lag: float) -> Guard:
    """Return the guard of a base; `lag` (s) is the time from the mux's output until the wheels have followed it."""
    return Guard(sight, (min(_GENTLE, limits.deceleration), min(_GENTLE_TURN, limits.angular_deceleration)), lag)


def reach_of(hull: Hull, limits: MotionLimits) -> float:
    """Return how far (m) from the origin of the base a point may matter."""
    braking = limits.velocity / min(_GENTLE, limits.deceleration) / 2.0
    return hull.radius + limits.velocity * (braking + SILENT + limits.lag) + 0.5


def side_of(hull: Hull, point: Floats) -> Side:
    """Return the side of the outline on which a point lies furthest out."""
    (low_x, low_y), (high_x, high_y) = hull.corners.min(axis=0), hull.corners.max(axis=0)
    x, y = float(point[0]), float(point[1])
    out: dict[Side, float] = {
        "ahead": x - high_x,
        "behind": low_x - x,
        "on the left": y - high_y,
        "on the right": low_y - y,
    }
    return max(out, key=lambda side: out[side])


def _share(time: float, reaction: float, braking: float) -> float:
    """Solve the equation of this module's text for the share, 0 to 1."""
    if time <= 0.0:
        return 0.0
    if braking < 1e-6:
        return min(1.0, time / reaction)
    return (
        min(1.0, (math.sqrt(reaction * reaction + 2.0 * braking * time) - reaction) / braking)
        if time < math.inf
        else 1.0
    )
