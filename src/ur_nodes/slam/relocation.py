"""Find the place of a scan on a whole map without a guess, and agree on one place for several scans."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.contradiction import contradiction
from ur_nodes.slam.matching.correlative import Pyramid, Window, search, search_places
from ur_nodes.slam.matching.covariance import position_deviation, rotate_covariance
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import match_surface
from ur_nodes.slam.matching.scan import Scan
from ur_nodes.slam.matching.surface import Floats, join
from ur_nodes.slam.pose_graph.edge import Edge
from ur_nodes.slam.pose_graph.views import select_views

_CELL = 0.2  # m: of the search of the whole map
_POINTS = 120  # of a scan, in a search
_LEAST_POINTS = 20  # of a scan that is looked for
_MOST_WALLS = 60000  # points of the whole map
_PLACES = 10  # that are looked at closely
_FINE = Window(0.35, 0.12)  # round each of them
_LEAST_SCORE = 0.5
_ROUND = 6.0  # m: keyframes within show the place
_MEMBERS = 9
_FITS = (0.6, 0.2)  # least agreement, most contradiction
_FITS_ALONE = (0.85, 0.05)  # likewise, for a scan that needs no second one
_WORSE = 0.1  # agreement by which another place may be behind the best one
_WEAK = 0.5  # of a keyframe: a fit that would need a second one, where the robot may be off the map
_CERTAIN = 0.1  # m: along a bare corridor a scan fits everywhere
_SAME = (0.3, 0.1)  # m, rad: fits of several scans that agree on the place
_LEAD = 2  # scans by which a place must be ahead of the others
_LEAD_ANYWHERE = 3  # likewise where the robot may be off the map
_REFUTED = (0.5, 0.3)  # agreement below and contradiction above which a scan was not taken at a place
_CHECKED = 6  # places that a scan is held against which it does not name itself


@dataclass(frozen=True, slots=True)
class Fit:
    """The `pose` of a scan on the map, and the edge from keyframe `before` there; `alone`: it needs no second one."""

    pose: Pose2
    before: int
    relative: Pose2
    covariance: Floats
    agreement: float
    alone: bool


@dataclass(frozen=True, slots=True)
class Verdict:
    """A scan against one place: its `fit` there, None where that is not clear; `refuted`: it was not taken there."""

    fit: Fit | None
    refuted: bool


_UNCLEAR = Verdict(None, refuted=False)


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
        """Return the places where a scan fits about as well as at the best one, that first.

        Rooms with right angles agree with each other in two thirds of a scan and more, so that every place fits a
        little.
        """
        if len(scan.surface) < _LEAST_POINTS:
            return []
        points = scan.surface.sample(_POINTS)
        rough = search_places(self._pyramid, points, self._centre, self._window, _PLACES, _LEAST_SCORE)
        fits: list[Fit] = []
        for pose, _ in rough:
            fit = self._verify(scan, points, pose).fit
            if fit and not any(_is_same(fit.pose, other.pose) for other in fits):
                fits.append(fit)
        fits.sort(key=lambda fit: -fit.agreement)
        return [fit for fit in fits if fit.agreement >= fits[0].agreement - _WORSE]

    def check(self, scan: Scan, guess: Pose2) -> Verdict:
        """Hold a scan against the map at one place; off the map, nothing is refuted."""
        if len(scan.surface) < _LEAST_POINTS:
            return _UNCLEAR
        return self._verify(scan, scan.surface.sample(_POINTS), guess)

    def _verify(self, scan: Scan, points: Floats, guess: Pose2) -> Verdict:
        members = self._members(guess)
        if not members:
            return _UNCLEAR
        target = LocalMap([(self._poses[number], self._scans[number].surface) for number in members])
        found = search(target.pyramid, points, guess, _FINE, _LEAST_SCORE)
        match = match_surface(target, scan.surface, found.pose if found else guess)
        against = contradiction(target.surface, scan, match.pose)
        uncertain = position_deviation(match.covariance) > _CERTAIN
        if found is None or uncertain or match.agreement < _FITS[0] or against > _FITS[1]:
            return Verdict(None, match.agreement < _REFUTED[0] and against > _REFUTED[1])
        anchor = members[0]
        fit = Fit(
            match.pose,
            anchor,
            self._poses[anchor].inverse().compose(match.pose),
            rotate_covariance(match.covariance, match.pose.yaw),
            match.agreement,
            alone=match.agreement >= _FITS_ALONE[0] and against <= _FITS_ALONE[1],
        )
        return Verdict(fit, refuted=False)

    def _members(self, here: Pose2) -> list[int]:
        """Choose keyframes near a pose of which no two show the same, the nearest first."""
        gaps = np.hypot(self._places[:, 0] - here.x, self._places[:, 1] - here.y)
        nearest = np.argsort(gaps)
        return select_views(self._places, nearest[gaps[nearest] <= _ROUND].tolist(), _MEMBERS)


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A `place` on the map for the frame of other keyframes, and their fits that agree on it, by their numbers.

    `refuted` is the number of keyframes that were not taken there.
    """

    place: Pose2
    fits: tuple[tuple[int, Fit], ...]
    refuted: int = 0

    def links(self) -> list[Edge]:
        """The edges from keyframes of the map to the others."""
        return [Edge(fit.before, number, fit.relative, fit.covariance, robust=True) for number, fit in self.fits]


class Hypotheses:
    """The places where keyframes that were made elsewhere may lie on a map, each with the scans that speak for it."""

    def __init__(self, *, on_map: bool) -> None:
        """`on_map`: the robot certainly is at a place that is mapped, so that less evidence is enough."""
        self._on_map = on_map
        self._lead = _LEAD if on_map else _LEAD_ANYWHERE
        self._weak = 1.0 if on_map else _WEAK
        self._all: list[Hypothesis] = []
        self._count = 0

    def add(
        self, number: int, pose: Pose2, fits: Sequence[Fit], check: Callable[[Pose2], Verdict] | None = None
    ) -> None:
        """Take the fits of keyframe `number`, which has `pose` in the frame of the other keyframes.

        With `check`, the keyframe is also held against the best places that are not among its fits: a search of the
        whole map returns only so many of the places that look alike, and tells of none that it does not fit.
        """
        self._count += 1
        named: set[int] = set()
        for fit in fits:
            for index, known in enumerate(self._all):
                if index not in named and _is_same(known.place.compose(pose), fit.pose):
                    self._back(index, number, pose, fit)
                    named.add(index)
                    break
            else:
                self._all.append(Hypothesis(fit.pose.compose(pose.inverse()), ((number, fit),)))
                named.add(len(self._all) - 1)
        if check:
            best = max((fit.agreement for fit in fits), default=0.0)
            others = [index for index in range(len(self._all)) if index not in named]
            for index in others[:_CHECKED]:
                known = self._all[index]
                verdict = check(known.place.compose(pose))
                found = verdict.fit
                if found and found.agreement >= best - _WORSE and _is_same(known.place.compose(pose), found.pose):
                    self._back(index, number, pose, found)
                elif verdict.refuted:
                    self._all[index] = replace(known, refuted=known.refuted + 1)
        self._all = [each for each in self._all if self._support(each) > 0.0]
        self._all.sort(key=lambda each: -self._support(each))

    def _support(self, each: Hypothesis) -> float:
        """The number of keyframes that speak for a place, weak fits counting less, less those that speak against it."""
        return sum(1.0 if fit.alone else self._weak for _, fit in each.fits) - each.refuted

    def _back(self, index: int, number: int, pose: Pose2, fit: Fit) -> None:
        known = self._all[index]
        place = fit.pose.compose(pose.inverse())
        self._all[index] = replace(known, place=place, fits=(*known.fits, (number, fit)))

    def winner(self) -> Hypothesis | None:
        """Return the place that is ahead of all others; None as long as there is no such."""
        if not self._all:
            return None
        best = self._all[0]
        if len(self._all) == 1 and self._count == 1:
            return best if self._on_map and best.fits[0][1].alone else None
        second = self._support(self._all[1]) if len(self._all) > 1 else 0.0
        return best if self._support(best) - second >= self._lead else None

    def rivals(self) -> list[Hypothesis]:
        """Return the places that the best one is not far enough ahead of, and itself; none where it is alone."""
        least = self._support(self._all[0]) - self._lead if self._all else 0.0
        near = [each for each in self._all if self._support(each) > least]
        return near if len(near) > 1 else []


def _is_same(one: Pose2, other: Pose2) -> bool:
    near = math.hypot(one.x - other.x, one.y - other.y) < _SAME[0]
    return near and abs(wrap_angle(one.yaw - other.yaw)) < _SAME[1]
