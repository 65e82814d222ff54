"""Closes loops: chooses places that may have been seen before, verifies some with each scan, and adds the links."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.correlative import Window, Work, search_slowly
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import LEAST_NOISE, ScanMatch, contradiction, match_surface, rotate_covariance
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats
from ur_nodes.slam.pose_graph.graph import PoseGraph

_NEIGHBOUR = 2.0  # m: farther keyframes are no neighbours
_MOST = 4  # neighbours of a keyframe, the nearest ones
_KNOWN = 0.12  # m: with more uncertainty, whether they are neighbours is for loops to find out
_LEAST_POINTS = 20  # of a scan
_LEAST_NEAR_AGREEMENT = 0.5
_MOST_MOVED_NEAR = 0.3  # m: from where a match began
_LOOKS = 20  # keyframes whose neighbours are looked up at once
_ENOUGH = 24  # edges after which the poses are computed again
_IDLE = 8  # calls with nothing to do, after which they are for fewer
_STEPS = 2  # of that computation: these edges move poses little


class NeighbourMatcher:
    """Adds edges between keyframes near each other. A call of `step` takes no longer than one match."""

    def __init__(self, graph: PoseGraph, scans: Sequence[MapScan]) -> None:
        """`scans` are those of the graph's keyframes."""
        self._graph, self._scans = graph, scans
        self._waiting: deque[int] = deque()  # keyframes
        self._number = 0  # the keyframe whose turn it is
        self._others: list[int] = []  # that are still to be matched to it
        self._target: LocalMap | None = None  # made of it
        self._tried: set[tuple[int, int]] = set()
        self._added = 0  # edges since the poses were computed last
        self._idle = 0  # calls with nothing to do

    def add(self, number: int) -> None:
        """Schedule the match of a new keyframe to its neighbours, before all waiting ones."""
        self._waiting.appendleft(number)

    def add_all(self) -> None:
        """Schedule all keyframes again, as their poses have changed and others may be neighbours."""
        known = set(self._waiting)
        self._waiting.extend(number for number in range(len(self._scans)) if number not in known)

    def restart(self) -> None:
        """Schedule all keyframes of a graph that was extended; those with an edge are not matched again."""
        self._tried = {_ends(edge.before, edge.after) for edge in self._graph.edges}
        self._others = []
        self.add_all()

    def step(self) -> bool:
        """Look up neighbours, and match two keyframes; False if nothing is left."""
        for _ in range(_LOOKS):
            if self._others or not self._waiting or self._choose(self._waiting.popleft()):
                break
        if self._others:
            self._match(self._number, self._others.pop())
        self._idle = 0 if self._others or self._waiting else self._idle + 1
        if self._added >= _ENOUGH or (self._added and self._idle >= _IDLE):
            self._added = 0
            self._graph.begin(_STEPS)
        return self._idle == 0

    def _choose(self, number: int) -> bool:
        """Select a keyframe, with the neighbours that it was not matched to before; False if there are none."""
        places = np.array(self._graph.poses)[:, :2]
        gaps = np.hypot(*(places - places[number]).T)
        gaps[number] = np.inf
        nearest = np.argsort(gaps)[:_MOST]
        near = nearest[gaps[nearest] < _NEIGHBOUR].tolist()
        new = [other for other in near if _ends(number, other) not in self._tried]
        if not new:
            return False
        spread = self._graph.spread_from(number, _KNOWN)
        self._number, self._target = number, None
        self._others = [other for other in new if np.isfinite(spread[other])]
        return True

    def _match(self, number: int, other: int) -> None:
        self._tried.add(_ends(number, other))
        surface, poses = self._scans[other].surface, self._graph.poses
        if min(len(surface), len(self._scans[number].surface)) < _LEAST_POINTS:
            return
        if self._target is None:
            self._target = LocalMap([(Pose2(0.0, 0.0, 0.0), self._scans[number].surface)])
        guess = poses[number].inverse().compose(poses[other])
        match = match_surface(self._target, surface, guess)
        moved = math.hypot(match.pose.x - guess.x, match.pose.y - guess.y)
        if match.agreement < _LEAST_NEAR_AGREEMENT or moved > _MOST_MOVED_NEAR:
            return
        covariance = rotate_covariance(match.covariance, match.pose.yaw) + LEAST_NOISE
        self._graph.add_edge(number, other, match.pose, covariance, robust=True)
        self._added += 1


def _ends(one: int, other: int) -> tuple[int, int]:
    return min(one, other), max(one, other)


RECENT = 12
"""Keyframes before the newest one that it is no loop to see again."""

_NEAR = 2.5  # m: keyframes so near see the same things, as a rule,
_FARTHEST = 8.0  # m: and so far ones may where a scan sees far
_GROUP = 7  # keyframes
_MOST_GROUPS = 2
_SURE = 0.12  # m: with less uncertainty the scan is matched from where it is
_WIDEST = Window(8.0, 0.5)
_POINTS = 150  # of a scan, in a search
_LEAST_SCORE = 0.55
_WEAK_SCORE = 0.4  # of a weak link, which no other place rivals and nothing contradicts
_RIVAL = 0.85  # of the best score: another place that fits as well
_FITS, _FITS_WEAKLY = (0.6, 0.15), (0.5, 0.05)  # least agreement, most contradiction
_COST_OF_MAP = 4000  # as much as to score so many blocks of poses: a local map, or a match
_MOST_MOVED = 0.4  # m: from where a match began
_AGREEMENT = (0.25, 0.05)  # m, rad: corrections of two links that confirm each other differ by less


@dataclass(frozen=True, slots=True)
class KeyframeGroup:
    """Keyframes that were made one after the other near a place, and the uncertainty (m) of the place to them."""

    members: tuple[int, ...]
    anchor: int
    spread: float


@dataclass(frozen=True, slots=True)
class PoseLink:
    """The pose of keyframe `after` in the frame of `before`; not `sure`: it needs confirmation by another one.

    `weak`: by two others, as much of the scan was not seen before.
    """

    before: int
    after: int
    relative: Pose2
    covariance: Floats
    sure: bool
    correction: Pose2
    weak: bool = False


def find_groups(
    poses: Sequence[Pose2], number: int, spread: NDArray[np.float64], last: int, near: float = _NEAR
) -> list[KeyframeGroup]:
    """Choose groups of the keyframes before `last` that keyframe `number` may see, the nearest first.

    `spread` (n) is how uncertain their places are relative to it, m; those with inf are left out. Uncertain ones may be
    as far away as `near` (m).
    """
    if last <= 0:
        return []
    places = np.array([pose[:2] for pose in poses[:last]])
    gaps = np.hypot(*(places - poses[number][:2]).T)
    known = np.isfinite(spread[:last])
    reach = np.where(spread[:last] < _SURE, _NEAR, np.clip(near, _NEAR, _FARTHEST))
    within = np.flatnonzero(known & (gaps < reach + np.minimum(3.0 * spread[:last], _WIDEST.shift)))
    if not len(within):
        return []
    runs = np.split(within, np.flatnonzero(np.diff(within) > 1) + 1)
    groups = []
    for run in runs:
        nearest = int(run[np.argmin(gaps[run])])
        members = run[np.argsort(np.abs(run - nearest))[:_GROUP]]
        groups.append(
            (float(gaps[nearest]), KeyframeGroup(tuple(sorted(members.tolist())), nearest, float(spread[nearest])))
        )
    return [group for _, group in sorted(groups, key=lambda each: each[0])[:_MOST_GROUPS]]


def verify_group(
    group: KeyframeGroup, number: int, poses: Sequence[Pose2], scans: Sequence[MapScan], *, weak: bool = False
) -> Work[PoseLink | None]:
    """Match the scan of a keyframe to a group; None when it was not taken there, or may have been taken elsewhere.

    The poses must not change meanwhile. `weak`: return weak links, too.
    """
    placed = [(poses[member], scans[member].surface) for member in group.members]
    target = LocalMap(placed)
    scan, guess = scans[number], poses[number]
    start = guess
    sure = group.spread < _SURE
    score, rivalled = 1.0, sure
    if not sure:
        window = Window(min(_WIDEST.shift, 3.0 * group.spread + 0.2), min(_WIDEST.turn, group.spread + 0.1))
        yield _COST_OF_MAP
        least = _WEAK_SCORE if weak else _LEAST_SCORE
        found = yield from search_slowly(target.pyramid, scan.surface.sample(_POINTS), guess, window, least)
        if found is None or found.rival > _RIVAL * found.score:
            return None
        start, score, rivalled = found.pose, found.score, found.rival > 0.0
    yield _COST_OF_MAP
    match = match_surface(target, scan.surface, start)
    is_weak = score < _LEAST_SCORE or not _fits(match, start, target, scan, _FITS)
    if is_weak and (rivalled or not weak or not _fits(match, start, target, scan, _FITS_WEAKLY)):
        return None
    anchor = poses[group.anchor]
    return PoseLink(
        group.anchor,
        number,
        anchor.inverse().compose(match.pose),
        rotate_covariance(match.covariance, match.pose.yaw),
        sure,
        match.pose.compose(guess.inverse()),
        is_weak,
    )


def agree(one: PoseLink, other: PoseLink, pose: Pose2) -> bool:
    """Test two links for the same correction of a pose on the map."""
    a, b = one.correction.compose(pose), other.correction.compose(pose)
    return math.hypot(a.x - b.x, a.y - b.y) < _AGREEMENT[0] and abs(wrap_angle(a.yaw - b.yaw)) < _AGREEMENT[1]


def _fits(match: ScanMatch, start: Pose2, target: LocalMap, scan: MapScan, limits: tuple[float, float]) -> bool:
    moved = math.hypot(match.pose.x - start.x, match.pose.y - start.y)
    return (
        match.agreement >= limits[0]
        and moved < _MOST_MOVED
        and contradiction(target.surface, scan, match.pose) <= limits[1]
    )


_LONGEST = 20.0  # m: places that are less certain are not looked at
_BACKLOG = 2  # keyframes that may wait when another one is made
_BUDGET = 8000  # blocks of poses that are scored with a scan
_MOST_BUDGETS = 5  # times as many where more keyframes wait
_COST_OF_MATCH = 4000  # as much as to score so many blocks
_PATIENCE = 24  # keyframes for which a loop waits for confirmation


class Confirmation:
    """Uncertain links, each waiting for another one that agrees with it."""

    def __init__(self, patience: int) -> None:
        """Links wait for this many keyframes."""
        self._patience = patience
        self._waiting: list[PoseLink] = []

    def confirm(self, link: PoseLink, poses: Sequence[Pose2]) -> list[PoseLink]:
        """Return the link and the waiting ones that agree with it; none, and the link waits, if there are none."""
        if link.sure:
            return [link]
        self._waiting = [each for each in self._waiting if link.after - each.after <= self._patience]
        place = poses[link.after]
        friends = [each for each in self._waiting if each.after != link.after and agree(each, link, place)]
        self._waiting.append(link)
        strong = {each.after for each in (link, *friends) if not each.weak}
        if len({each.after for each in friends}) < (1 if len(strong) > 1 else 2):
            return []
        self._waiting = [each for each in self._waiting if each is not link and each not in friends]
        return [*friends, link]


class LoopCloser:
    """Adds links to a pose graph where keyframes were taken at places that were mapped before.

    To verify a place may take longer than there is between two scans, so it is done in parts, some with each scan.
    """

    def __init__(self, graph: PoseGraph, scans: Sequence[MapScan]) -> None:
        """`scans` are those of the graph's keyframes."""
        self._graph, self._scans = graph, scans
        self._waiting: deque[int] = deque()  # keyframes
        self._groups: deque[tuple[int, KeyframeGroup]] = deque()  # places of the keyframe whose turn it is
        self._verification: Work[PoseLink | None] | None = None  # of one of them
        self._confirmation = Confirmation(_PATIENCE)
        self._neighbours = NeighbourMatcher(graph, scans)
        self.loops = 0
        """The number of links so far."""

    def add_keyframe(self, number: int) -> bool:
        """Schedule the search for the place of a new keyframe; returns whether poses have changed, as `step` does."""
        self._waiting += [number] if len(self._scans[number].surface) >= _LEAST_POINTS else []
        self._neighbours.add(number)
        return len(self._waiting) > _BACKLOG and self.step()

    def step(self, spare: int = 0) -> bool:
        """Optimise the poses after the last link, then verify places for a while; returns whether poses changed.

        Without a place to verify, neighbours are matched, `spare` pairs of them at most.
        """
        budgets = min(_MOST_BUDGETS, 1 + len(self._waiting) // (_BACKLOG + 1))
        changed = False
        if not self._verification:  # which needs poses that stay
            for _ in range(budgets):
                changed |= self._graph.step()
            if self._graph.unsettled:
                return changed
        left = _BUDGET * budgets
        while left > 0 and (self._verification or self._begin_next()):
            assert self._verification is not None
            try:
                left -= next(self._verification)
            except StopIteration as end:
                self._verification = None
                left -= _COST_OF_MATCH
                if self._add_link(end.value):
                    return True
        if not changed and left == _BUDGET * budgets:
            while spare > 0 and self._neighbours.step():
                spare -= 1
        return changed

    def restart(self) -> None:
        """Forget the places that wait, as the graph was made larger."""
        self._waiting.clear()
        self._groups.clear()
        self._verification = None
        self._confirmation = Confirmation(_PATIENCE)
        self._neighbours.restart()

    def _begin_next(self) -> bool:
        """Start to verify the next place; False if there is none."""
        while self._waiting and not self._groups:
            number = self._waiting.popleft()
            spread = self._graph.spread_from(number, _LONGEST)
            near = float(np.median([_NEAR, *np.hypot(*self._scans[number].surface.points.T)]))
            groups = find_groups(self._graph.poses, number, spread, number - RECENT, near)
            self._groups.extend((number, group) for group in groups)
        if not self._groups:
            return False
        number, group = self._groups.popleft()
        self._verification = verify_group(group, number, self._graph.poses, self._scans, weak=True)
        return True

    def _add_link(self, link: PoseLink | None) -> bool:
        """Add the links that a verified one (None: another place) confirms; returns whether poses moved."""
        links = self._confirmation.confirm(link, self._graph.poses) if link else []
        for each in links:
            covariance = each.covariance + LEAST_NOISE
            ends = each.before, each.after
            self._graph.add_edge(*ends, each.relative, covariance, robust=True, confirmed=not each.sure)
        self.loops += len(links)
        if links:
            self._graph.begin()
            self._graph.step()
            self._neighbours.add_all()
        return bool(links)
