"""Search for one place of the map on which several successive scans agree."""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.map_state import Edge
from ur_nodes.slam.relocation import WORSE, Fit, PlaceVerdict, is_same_place

_WEAK = 0.5  # of a keyframe: a fit that would need a second one, where the robot may be off the map
_LEAD = 2  # scans by which a place must be ahead of the others
_LEAD_ANYWHERE = 3  # likewise where the robot may be off the map
_EXPECTED = 1.0  # scans that the place counts as where the robot is unless it was carried
_DRIFTED = (0.7, 0.25)  # m, rad: so far the small map may have moved from there among people
_TELLING = 0.05  # share of walls looked through that counts as much as a scan: small differences add up
_CHECKED = 6  # places that a scan is held against which it does not name itself


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A `pose` on the map for the frame of other keyframes, and their fits that agree on it, by keyframe.

    `refuted` is the number of keyframes that were not taken there; `expected`: the robot is there unless it was
    carried.
    `against` is the sum of the walls that they look through there, and not at another place (shares).
    """

    pose: Pose2
    fits: tuple[tuple[int, Fit], ...]
    refuted: int = 0
    expected: bool = False
    against: float = 0.0

    def links(self) -> list[Edge]:
        """The edges from keyframes of the map to the others."""
        return [Edge(fit.before, number, fit.relative, fit.covariance, robust=True) for number, fit in self.fits]


class Hypotheses:
    """Candidate places on a map for keyframes of another map, each with its supporting scans."""

    def __init__(self, *, on_map: bool, expected: Pose2 | None = None) -> None:
        """`on_map`: the robot is certainly at a mapped place, so that less evidence is enough.

        `expected` is the place of the other keyframes' frame if the robot was not carried, and only people stood around
        it.
        """
        self._on_map = on_map
        self._lead = _LEAD if on_map else _LEAD_ANYWHERE
        self._weak = 1.0 if on_map else _WEAK
        # The best supported first.
        self._all = [Hypothesis(expected, (), expected=True)] if expected else []
        self._count = 0  # of keyframes

    def add(
        self, number: int, pose: Pose2, fits: Sequence[Fit], check: Callable[[Pose2], PlaceVerdict] | None = None
    ) -> None:
        """Take the fits of keyframe `number`, which has `pose` in the frame of the other keyframes.

        With `check`, the keyframe is also checked against the best places that are not among its fits: a search of the
        whole map returns only so many of the places that look alike, and tells of none that it does not fit.
        """
        self._count += 1
        named: dict[int, float] = {}  # the walls looked through, by index
        for fit in fits:
            named[self._take(number, pose, fit, named)] = fit.against
        if check:
            best = max((fit.agreement for fit in fits), default=0.0)
            others = [index for index in range(len(self._all)) if index not in named]
            for index in others[:_CHECKED]:
                named[index] = self._check(index, number, pose, check, best)
        least = min(named.values(), default=0.0)
        for index, against in named.items():
            known = self._all[index]
            if known.fits or not known.expected:  # those who stand round are looked through at no place
                self._all[index] = replace(known, against=known.against + against - least)
        self._all = [each for each in self._all if self._support(each) > 0.0]
        self._all.sort(key=lambda each: -self._support(each))

    def _support(self, each: Hypothesis) -> float:
        """Return the weighted number of keyframes that support a place, minus those that contradict it."""
        against = each.refuted + each.against / _TELLING
        if each.expected:
            return _EXPECTED + len(each.fits) - against
        return sum(1.0 if fit.alone else self._weak for _, fit in each.fits) - against

    def _take(self, number: int, pose: Pose2, fit: Fit, named: Collection[int]) -> int:
        """Add a fit to the first place but those `named` that it agrees with, or as a new one; return its index."""
        for index, known in enumerate(self._all):
            if index not in named and _agrees(known, pose, fit):
                self._support_with(index, number, pose, fit)
                return index
        self._all.append(Hypothesis(fit.pose.compose(pose.inverse()), ((number, fit),)))
        return len(self._all) - 1

    def _check(
        self, index: int, number: int, pose: Pose2, check: Callable[[Pose2], PlaceVerdict], best: float
    ) -> float:
        """Check a keyframe against a place that is not among its fits, whose agreement is `best` at most.

        Return the share of walls that are looked through there.
        """
        known = self._all[index]
        expected = known.pose.compose(pose)
        verdict = check(expected)
        found = verdict.fit
        if found and found.agreement >= best - WORSE and _agrees(known, pose, found):
            self._support_with(index, number, pose, found)
        elif verdict.refuted and (known.fits or not known.expected):  # people who stand round refute their place, too
            self._all[index] = replace(known, refuted=known.refuted + 1)
        return verdict.against

    def _support_with(self, index: int, number: int, pose: Pose2, fit: Fit) -> None:
        known = self._all[index]
        place = fit.pose.compose(pose.inverse())
        self._all[index] = replace(known, pose=place, fits=(*known.fits, (number, fit)))

    def winner(self) -> Hypothesis | None:
        """Return the place that is clearly ahead of all others; None without one."""
        seen = [each for each in self._all if each.fits]
        if not seen:
            return None
        best = seen[0]
        if len(seen) == 1 and self._count == 1:
            return best if self._on_map and best.fits[0][1].alone else None
        second = self._support(seen[1]) if len(seen) > 1 else 0.0
        return best if self._support(best) - second >= self._lead else None

    def rivals(self) -> list[Hypothesis]:
        """Return the best place and those close to it in support; none if the best one is alone."""
        seen = [each for each in self._all if each.fits]
        least = self._support(seen[0]) - self._lead if seen else 0.0
        near = [each for each in seen if self._support(each) > least]
        return near if len(near) > 1 else []


def _agrees(known: Hypothesis, pose: Pose2, fit: Fit) -> bool:
    """Return whether a keyframe at `pose` in the frame of the others fits the map where a hypothesis puts it."""
    expected = known.pose.compose(pose)
    if known.expected and not known.fits:
        moved = expected.inverse().compose(fit.pose)
        return math.hypot(moved.x, moved.y) < _DRIFTED[0] and abs(moved.yaw) < _DRIFTED[1]
    return is_same_place(expected, fit.pose)
