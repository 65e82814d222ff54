"""Find the place of a scan on a whole map without a guess."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.map_state import select_views
from ur_nodes.slam.matching.correlative import Pyramid, Window, search, search_poses
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import contradiction, match_surface, position_deviation, rotate_covariance
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats, join

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
_CERTAIN = 0.1  # m: along a bare corridor a scan fits everywhere
_SAME = (0.3, 0.1)  # m, rad: fits of several scans that agree on the place
_REFUTED = (0.5, 0.3)  # agreement below and contradiction above which a scan was not taken at a place

WORSE = 0.1
"""Agreement by which another place may be behind the best one."""


@dataclass(frozen=True, slots=True)
class Fit:
    """The `pose` of a scan on the map, and the edge from keyframe `before` there; `alone`: it needs no second one.

    `against` is the share of walls that are looked through there: of the map by the scan, and of the scan by the map.
    """

    pose: Pose2
    before: int
    relative: Pose2
    covariance: Floats
    agreement: float
    alone: bool
    against: float = 0.0


@dataclass(frozen=True, slots=True)
class PlaceVerdict:
    """A scan checked at one place: its `fit` there, None if unclear; `refuted`: it was not taken there.

    `against` is as of a fit.
    """

    fit: Fit | None
    refuted: bool
    against: float = 0.0


_UNCLEAR = PlaceVerdict(None, refuted=False)


class WholeMap:
    """The keyframes of a map, which are searched for the place of a scan."""

    def __init__(self, poses: Sequence[Pose2], scans: Sequence[MapScan]) -> None:
        """Requires at least one keyframe."""
        self._poses, self._scans = list(poses), list(scans)
        self._places = np.array(self._poses)
        walls = join([scan.surface.moved(pose) for pose, scan in zip(poses, scans, strict=True)])
        points = walls.thinned(_MOST_WALLS).points
        self._pyramid = Pyramid(points, _CELL)
        low, high = self._places[:, :2].min(axis=0), self._places[:, :2].max(axis=0)
        middle = 0.5 * (low + high)
        self._centre = Pose2(float(middle[0]), float(middle[1]), 0.0)
        self._window = Window(float((high - low).max()) * 0.5 + _ROUND / 2.0, math.pi)

    def find(self, scan: MapScan) -> list[Fit]:
        """Return the places where a scan fits about as well as at the best one, which is the first.

        Rectangular rooms agree with each other in two thirds of a scan and more, so that every place fits partly.
        """
        if len(scan.surface) < _LEAST_POINTS:
            return []
        points = scan.surface.sample(_POINTS)
        rough = search_poses(self._pyramid, points, self._centre, self._window, _PLACES, _LEAST_SCORE)
        fits: list[Fit] = []
        for pose, _ in rough:
            fit = self._verify(scan, points, pose).fit
            if fit and not any(is_same_place(fit.pose, other.pose) for other in fits):
                fits.append(fit)
        fits.sort(key=lambda fit: -fit.agreement)
        return [fit for fit in fits if fit.agreement >= fits[0].agreement - WORSE]

    def check(self, scan: MapScan, guess: Pose2) -> PlaceVerdict:
        """Check a scan against the map at one place; outside the map, nothing is refuted."""
        if len(scan.surface) < _LEAST_POINTS:
            return _UNCLEAR
        return self._verify(scan, scan.surface.sample(_POINTS), guess)

    def _verify(self, scan: MapScan, points: Floats, guess: Pose2) -> PlaceVerdict:
        # Choose keyframes near a pose of which no two show the same, the nearest first
        gaps = np.hypot(self._places[:, 0] - guess.x, self._places[:, 1] - guess.y)
        nearest = np.argsort(gaps)
        members = select_views(self._places, nearest[gaps[nearest] <= _ROUND].tolist(), _MEMBERS)
        if not members:
            return _UNCLEAR
        target = LocalMap([(self._poses[number], self._scans[number].surface) for number in members])
        found = search(target.pyramid, points, guess, _FINE, _LEAST_SCORE)
        match = match_surface(target, scan.surface, found.pose if found else guess)
        through = contradiction(target.surface, scan, match.pose)
        # The share of a scan's points at a pose that keyframes in sight of them look through, in the mean of these
        placed = scan.surface.moved(match.pose)
        shares = [contradiction(placed, self._scans[number], self._poses[number]) for number in members]
        against = through + float(np.mean(shares))
        uncertain = position_deviation(match.covariance) > _CERTAIN
        if found is None or uncertain or match.agreement < _FITS[0] or through > _FITS[1]:
            return PlaceVerdict(None, match.agreement < _REFUTED[0] and through > _REFUTED[1], against)
        anchor = members[0]
        fit = Fit(
            match.pose,
            anchor,
            self._poses[anchor].inverse().compose(match.pose),
            rotate_covariance(match.covariance, match.pose.yaw),
            match.agreement,
            alone=match.agreement >= _FITS_ALONE[0] and through <= _FITS_ALONE[1],
            against=against,
        )
        return PlaceVerdict(fit, refuted=False, against=against)


def is_same_place(one: Pose2, other: Pose2) -> bool:
    """Test whether two poses of a scan, found independently, are the same place."""
    near = math.hypot(one.x - other.x, one.y - other.y) < _SAME[0]
    return near and abs(wrap_angle(one.yaw - other.yaw)) < _SAME[1]
