"""Find the place of a scan on a whole map without a guess, and agree on one place for several scans."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.correlative import Pyramid, Window, search, search_places
from ur_nodes.slam.edge import Edge
from ur_nodes.slam.local_map import LocalMap
from ur_nodes.slam.loops import contradiction, turned
from ur_nodes.slam.match import match_surface
from ur_nodes.slam.scan import Scan
from ur_nodes.slam.surface import Floats, join

_CELL = 0.2  # m: of the search of the whole map
_POINTS = 120  # of a scan, in a search
_MOST_WALLS = 60000  # points of the whole map
_PLACES = 10  # that are looked at closely
_FINE = Window(0.35, 0.12)  # round each of them
_LEAST_SCORE = 0.5
_ROUND = 6.0  # m: keyframes within show the place
_MEMBERS = 9
_APART = (0.3, 0.6)  # m, rad: nearer keyframes show the same
_FITS = (0.6, 0.2)  # least agreement, most contradiction
_FITS_ALONE = (0.85, 0.05)  # likewise, for a scan that needs no second one
_CERTAIN = 0.1  # m: along a bare corridor a scan fits everywhere
_SAME = (0.3, 0.1)  # m, rad: fits of several scans that agree on the place
_LEAD = 2  # scans by which a place must be ahead of the others
_LEAD_ANYWHERE = 3  # likewise where the robot may be off the map


@dataclass(frozen=True, slots=True)
class Fit:
    """The `pose` of a scan on the map, and the edge from keyframe `before` there; `alone`: it needs no second one."""

    pose: Pose2
    before: int
    relative: Pose2
    covariance: Floats
    agreement: float
    alone: bool


class WholeMap:
    """The keyframes of a map, to be searched for the place of a scan."""

    def __init__(self, poses: Sequence[Pose2], scans: Sequence[Scan]) -> None:
        """At least one keyframe that has seen something."""
        self._poses, self._scans = list(poses), list(scans)
        self._places = np.array(self._poses)
        walls = join([scan.surface.moved(pose) for pose, scan in zip(poses, scans, strict=True)])
        points = walls.thinned(_MOST_WALLS).points
        self._pyramid = Pyramid(points, _CELL)
        low, high = self._places[:, :2].min(axis=0), self._places[:, :2].max(axis=0)
        middle = 0.5 * (low + high)
        self._centre = Pose2(float(middle[0]), float(middle[1]), 0.0)
        self._window = Window(float((high - low).max()) * 0.5 + _ROUND / 2.0, math.pi)

    def find(self, scan: Scan) -> list[Fit]:
        """Return all places where a scan fits, the best first."""
        if len(scan.surface) < 20:
            return []
        points = scan.surface.points[:: max(1, len(scan.surface) // _POINTS)]
        rough = search_places(self._pyramid, points, self._centre, self._window, _PLACES, _LEAST_SCORE)
        fits: list[Fit] = []
        for pose, _ in rough:
            fit = self._verify(scan, points, pose)
            if fit and not any(_is_same(fit.pose, other.pose) for other in fits):
                fits.append(fit)
        return sorted(fits, key=lambda fit: -fit.agreement)

    def _verify(self, scan: Scan, points: Floats, guess: Pose2) -> Fit | None:
        members = self._members(guess)
        if not members:
            return None
        target = LocalMap([(self._poses[number], self._scans[number].surface) for number in members])
        found = search(Pyramid(target.surface.points), points, guess, _FINE, _LEAST_SCORE)
        if found is None:
            return None
        match = match_surface(target, scan.surface, found.pose)
        against = contradiction(target.surface, scan, match.pose)
        uncertain = math.sqrt(float(np.linalg.eigvalsh(match.covariance[:2, :2])[-1])) > _CERTAIN
        if uncertain or match.agreement < _FITS[0] or against > _FITS[1]:
            return None
        anchor = members[0]
        return Fit(
            match.pose,
            anchor,
            self._poses[anchor].inverse().compose(match.pose),
            turned(match.covariance, match.pose.yaw),
            match.agreement,
            alone=match.agreement >= _FITS_ALONE[0] and against <= _FITS_ALONE[1],
        )

    def _members(self, here: Pose2) -> list[int]:
        """Choose keyframes near a pose of which no two show the same, the nearest first."""
        gaps = np.hypot(self._places[:, 0] - here.x, self._places[:, 1] - here.y)
        chosen: list[int] = []
        for number in np.argsort(gaps).tolist():
            if gaps[number] > _ROUND or len(chosen) == _MEMBERS:
                break
            shift = np.hypot(*(self._places[chosen, :2] - self._places[number, :2]).T)
            swing = self._places[chosen, 2] - self._places[number, 2]
            swing = np.abs(np.remainder(swing + math.pi, 2.0 * math.pi) - math.pi)
            if not np.any((shift < _APART[0]) & (swing < _APART[1])):
                chosen.append(number)
        return chosen


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A `place` on the map for the frame of other keyframes, and their fits that agree on it, by their numbers."""

    place: Pose2
    fits: tuple[tuple[int, Fit], ...]

    def links(self) -> list[Edge]:
        """The edges from keyframes of the map to the others."""
        return [Edge(fit.before, number, fit.relative, fit.covariance, robust=True) for number, fit in self.fits]


class Hypotheses:
    """The places where keyframes that were made elsewhere may lie on a map, each with the scans that speak for it."""

    def __init__(self, *, on_map: bool) -> None:
        """`on_map`: the robot certainly is at a place that is mapped, so that less evidence is enough."""
        self._on_map = on_map
        self._lead = _LEAD if on_map else _LEAD_ANYWHERE
        self._all: list[Hypothesis] = []
        self._count = 0

    def add(self, number: int, pose: Pose2, fits: Sequence[Fit]) -> None:
        """Take the fits of keyframe `number`, which has `pose` in the frame of the other keyframes."""
        self._count += 1
        for fit in fits:
            place = fit.pose.compose(pose.inverse())
            for index, known in enumerate(self._all):
                if _is_same(known.place.compose(pose), fit.pose):
                    self._all[index] = Hypothesis(place, (*known.fits, (number, fit)))
                    break
            else:
                self._all.append(Hypothesis(place, ((number, fit),)))
        self._all.sort(key=lambda each: -len(each.fits))

    def winner(self) -> Hypothesis | None:
        """Return the place that is ahead of all others; None as long as there is no such."""
        if not self._all:
            return None
        best = self._all[0]
        if len(self._all) == 1 and self._count == 1:
            return best if self._on_map and best.fits[0][1].alone else None
        second = len(self._all[1].fits) if len(self._all) > 1 else 0
        return best if len(best.fits) - second >= self._lead else None

    def rivals(self) -> list[Hypothesis]:
        """Return the places that the best one is not far enough ahead of, and itself; none where it is alone."""
        near = [each for each in self._all if len(each.fits) > len(self._all[0].fits) - self._lead]
        return near if len(near) > 1 else []


def _is_same(one: Pose2, other: Pose2) -> bool:
    near = math.hypot(one.x - other.x, one.y - other.y) < _SAME[0]
    return near and abs(wrap_angle(one.yaw - other.yaw)) < _SAME[1]
