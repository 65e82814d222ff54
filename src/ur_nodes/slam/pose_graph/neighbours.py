"""Matches keyframes near each other, a few with each scan, and adds edges to the pose graph.

A keyframe has an edge to the one before it, and few others by loops; the errors of these few edges bend a map over long
distances. Edges between all neighbours average them out. Source of the idea: Lu and Milios, Globally consistent range
scan alignment for environment mapping, 1997.
"""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import LEAST_NOISE, match_surface, rotate_covariance
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.pose_graph.graph import PoseGraph

_NEAR = 2.0  # m: farther keyframes are no neighbours
_MOST = 4  # neighbours of a keyframe, the nearest ones
_KNOWN = 0.12  # m: with more uncertainty, whether they are neighbours is for loops to find out
_LEAST_POINTS = 20  # of a scan
_LEAST_AGREEMENT = 0.5
_MOST_MOVED = 0.3  # m: from where a match began
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
        near = nearest[gaps[nearest] < _NEAR].tolist()
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
        if match.agreement < _LEAST_AGREEMENT or moved > _MOST_MOVED:
            return
        covariance = rotate_covariance(match.covariance, match.pose.yaw) + LEAST_NOISE
        self._graph.add_edge(number, other, match.pose, covariance, robust=True)
        self._added += 1


def _ends(one: int, other: int) -> tuple[int, int]:
    return min(one, other), max(one, other)
