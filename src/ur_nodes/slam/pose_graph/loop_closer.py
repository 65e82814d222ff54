"""Closes loops: looks at places that may have been seen before, a little with each scan, and adds what it finds."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import Scan
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loops import LEAST_NOISE, RECENT, Group, Link, agree, find_groups, verify_group

_LONGEST = 20.0  # m: places that are less certain are not looked at
_BACKLOG = 2  # places that may wait to be looked at when a keyframe is made
_DOUBTFUL = 24  # keyframes for which a loop waits for confirmation


class Confirmation:
    """Links that are not sure, each waiting for another one that agrees with it."""

    def __init__(self, patience: int) -> None:
        """They wait for so many keyframes."""
        self._patience = patience
        self._waiting: list[Link] = []

    def confirm(self, link: Link, poses: Sequence[Pose2]) -> list[Link]:
        """Return the link and those that waited and agree with it; none, and it waits, when there is no such."""
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
    """Adds links to a pose graph where keyframes were taken at places that were mapped before."""

    def __init__(self, graph: PoseGraph, scans: Sequence[Scan]) -> None:
        """`scans` are those of the graph's keyframes."""
        self._graph, self._scans = graph, scans
        self._work: deque[tuple[int, Group]] = deque()
        self._doubtful = Confirmation(_DOUBTFUL)
        self.loops = 0

    def look_round(self, number: int) -> bool:
        """Plan to look for the place of a new keyframe; returns whether poses have changed, as `step` does."""
        changed = False
        while len(self._work) > _BACKLOG:
            changed |= self._look()
        spread = self._graph.spread_from(number, _LONGEST)
        groups = find_groups(self._graph.poses, number, spread, number - RECENT)
        self._work.extend((number, group) for group in groups)
        return changed

    def step(self) -> bool:
        """Look at one place, or go on with the poses that follow from the last link; whether poses have changed."""
        if self._graph.unsettled:
            self._graph.step()
            return True
        return bool(self._work) and self._look()

    def forget(self) -> None:
        """Forget the places that wait."""
        self._work.clear()
        self._doubtful = Confirmation(_DOUBTFUL)

    def _look(self) -> bool:
        number, group = self._work.popleft()
        link = verify_group(group, number, self._graph.poses, self._scans)
        links = self._doubtful.confirm(link, self._graph.poses) if link else []
        for each in links:
            self._graph.add_edge(each.before, each.after, each.relative, each.covariance + LEAST_NOISE, robust=True)
        self.loops += len(links)
        if links:
            self._graph.begin()
            self._graph.step()
        return bool(links)
