"""Closes loops: verifies places that may have been seen before, some with each scan, and adds the links found."""

from collections import deque
from collections.abc import Sequence

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.correlative import Work
from ur_nodes.slam.matching.covariance import LEAST_NOISE
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loops import RECENT, KeyframeGroup, PoseLink, agree, find_groups, verify_group
from ur_nodes.slam.pose_graph.neighbours import NeighbourMatcher

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
        if not friends:
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
        self._waiting.append(number)
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
            groups = find_groups(self._graph.poses, number, spread, number - RECENT)
            self._groups.extend((number, group) for group in groups)
        if not self._groups:
            return False
        number, group = self._groups.popleft()
        self._verification = verify_group(group, number, self._graph.poses, self._scans)
        return True

    def _add_link(self, link: PoseLink | None) -> bool:
        """Add the links that a verified one (None: another place) confirms; returns whether poses moved."""
        links = self._confirmation.confirm(link, self._graph.poses) if link else []
        for each in links:
            self._graph.add_edge(each.before, each.after, each.relative, each.covariance + LEAST_NOISE, robust=True)
        self.loops += len(links)
        if links:
            self._graph.begin()
            self._graph.step()
            self._neighbours.add_all()
        return bool(links)
