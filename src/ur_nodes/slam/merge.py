"""Merge two maps: find scans of one on the other, join the pose graphs, and refuse maps of different places.

Furniture that was moved between the two is no reason to refuse: the places where they differ are returned.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ur_nodes.geometry.grid import FREE, OCCUPIED
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.hypotheses import Hypotheses, Hypothesis
from ur_nodes.slam.map_state import Edge, MapState
from ur_nodes.slam.matching.correlative import finish
from ur_nodes.slam.matching.match import LEAST_NOISE
from ur_nodes.slam.matching.surface import Floats
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loop_closer import Confirmation, KeyframeGroup, PoseLink, find_groups, verify_group
from ur_nodes.slam.relocation import WholeMap

_TRIALS = 60  # scans of the second map that are searched for on the first one, at most
_LONGEST = 20.0  # m: places that are less certain are not looked at
_BATCH = 12  # links after which the poses are computed again
_MOST_LINKS = 400
_LEAST_LINKS = 4
_KNOWN, _NEAR = 0.12, 1.0  # m: a scan whose place is known so well, so near to one of the first map, should fit it
_MOST_CONFLICT = 0.33  # times the share of such scans that do: where most do, walls that contradict are furniture
_COARSE = 0.1  # m: cells in which both maps are compared
_LEAST_SHARE = 0.4  # of such scans that do
_TOGETHER, _LEAST_CHANGE = 0.35, 4  # m: so near to each other, so many cells are one place where the maps differ

Reason = Literal["no-scans", "no-overlap", "several-places", "contradiction"]


class Change(NamedTuple):
    """A rectangle (m) round a place where one map has walls and the other has free floor: its middle, and its sides."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True, eq=False)
class Merged:
    """The merged map in the frame of the first one; the keyframes of the second follow those of the first.

    `pose` is the pose of the second map's frame on the first map, `links` the number of edges between both, `changes`
    are the places where they differ, those with most walls first.
    """

    state: MapState
    pose: Pose2
    links: int
    changes: tuple[Change, ...] = ()


@dataclass(frozen=True, slots=True)
class NotMerged:
    """The reason why two maps were not merged.

    `no-scans`: one of them has none. `no-overlap`: no scan of one clearly fits the other. `several-places`: they do,
    but at the `poses` of the second map's frame equally well. `contradiction`: too few scans of the overlap fit.
    """

    reason: Reason
    poses: tuple[Pose2, ...] = ()


def merge_maps(first: MapState, second: MapState) -> Merged | NotMerged:
    """Merge two maps that partly show the same place. Where they differ, `second` is taken as the newer one."""
    if not all(any(len(scan.hits) for scan in state.scans) for state in (first, second)):
        return NotMerged("no-scans")
    found = _find_place(first, second)
    if isinstance(found, NotMerged):
        return found
    return _Merger(first, second, found).run()


def _find_place(first: MapState, second: MapState) -> Hypothesis | NotMerged:
    """Search for scans of the second map, in an order that covers it early, until they agree on one place."""
    whole, hypotheses = WholeMap(first.poses, first.scans), Hypotheses(on_map=False)
    # Choose keyframes, each as far from the earlier ones as possible
    places = np.array([pose[:2] for pose in second.poses])
    chosen = [0]
    gaps = np.hypot(*(places - places[0]).T)
    while len(chosen) < min(_TRIALS, len(second.poses)):
        farthest = int(np.argmax(gaps))
        if gaps[farthest] == 0.0:
            break
        chosen.append(farthest)
        gaps = np.minimum(gaps, np.hypot(*(places - places[farthest]).T))
    for number in chosen:
        hypotheses.add(number, second.poses[number], whole.find(second.scans[number]))
        winner = hypotheses.winner()
        if winner:
            return winner
    rivals = tuple(each.pose for each in hypotheses.rivals() if len(each.fits) > 1)
    return NotMerged("several-places", rivals) if len(rivals) > 1 else NotMerged("no-overlap")


class _Merger:
    """Two maps in one pose graph, joined by a growing number of links."""

    def __init__(self, first: MapState, second: MapState, found: Hypothesis) -> None:
        self._drives = [*first.drives, len(first.poses), *(each + len(first.poses) for each in second.drives)]
        self._count = len(first.poses)
        self._start = second.poses[0]
        self._scans = [*first.scans, *second.scans]
        self._graph = PoseGraph()
        for pose in (*first.poses, *(found.pose.compose(pose) for pose in second.poses)):
            self._graph.add_pose(pose)
        for edge in first.edges:
            self._add(edge)
        for edge in second.edges:
            self._add(edge._replace(before=edge.before + self._count, after=edge.after + self._count))
        for edge in found.links():
            self._add(edge._replace(after=edge.after + self._count, covariance=edge.covariance + LEAST_NOISE))
        self._linked = {number + self._count for number, _ in found.fits}
        self._anchor = found.fits[0][1].before
        self._links = len(self._linked)
        self._confirmation = Confirmation(len(self._scans))
        self._graph.optimise()

    def run(self) -> Merged | NotMerged:
        """Match all scans of the second map, starting with those whose place on the first one is most certain."""
        waiting = [number for number in range(self._count, len(self._scans)) if number not in self._linked]
        expected = fitting = self._links
        while waiting and self._links < _MOST_LINKS:
            spread = self._graph.spread_from(self._anchor, np.inf)
            waiting.sort(key=lambda number: float(spread[number]), reverse=True)
            before = self._links
            for number in [waiting.pop() for _ in range(min(_BATCH, len(waiting)))]:
                groups = self._groups(number)
                links = [finish(verify_group(group, number, self._graph.poses, self._scans)) for group in groups]
                known = any(group.spread < _KNOWN and self._gap(group.anchor, number) < _NEAR for group in groups)
                expected += known
                fitting += known and any(links)
                for link in filter(None, links):
                    self._tie(link)
            if self._links > before:
                self._graph.optimise()
        share, changes = self._compare()
        fit = fitting / max(1, expected)
        if self._links < _LEAST_LINKS or fit < _LEAST_SHARE or share > _MOST_CONFLICT * fit:
            return NotMerged("contradiction")
        state = MapState(self._graph.poses, list(self._graph.edges), self._scans, tuple(self._drives))
        return Merged(state, self._graph.poses[self._count].compose(self._start.inverse()), self._links, changes)

    def _compare(self) -> tuple[float, tuple[Change, ...]]:
        """Return the share of one map's walls, on floor that the other has seen, that are free there, and where."""
        grids = []
        for part in (slice(0, self._count), slice(self._count, None)):
            drawn = OccupancyMap(_COARSE)
            drawn.update(self._graph.poses[part], self._scans[part])
            grids.append(drawn.grid())
        known, against = 0, []
        for one, other in (grids, reversed(grids)):
            walls = one.points_of_cells(np.argwhere(one.values == OCCUPIED))
            free, solid = (other.points_of_cells(np.argwhere(other.values == each)) for each in (FREE, OCCUPIED))
            on_floor = cKDTree(free).query(walls)[0] < _COARSE
            near_wall = cKDTree(solid).query(walls)[0] < 2.5 * _COARSE
            known += int(np.sum(on_floor | near_wall))
            against.append(walls[on_floor & ~near_wall])
        points = np.vstack(against)
        return len(points) / max(1, known), _find_changes(points)

    def _groups(self, number: int) -> list[KeyframeGroup]:
        """Return places of the first map that a scan of the second one may show."""
        spread = self._graph.spread_from(number, _LONGEST)
        return find_groups(self._graph.poses, number, spread, self._count)

    def _gap(self, one: int, other: int) -> float:
        a, b = self._graph.poses[one], self._graph.poses[other]
        return math.hypot(a.x - b.x, a.y - b.y)

    def _tie(self, link: PoseLink) -> None:
        """Add a link, with those that waited for it; an uncertain one waits until another one agrees with it."""
        links = self._confirmation.confirm(link, self._graph.poses)
        for each in links:
            self._add(Edge(each.before, each.after, each.relative, each.covariance + LEAST_NOISE, robust=True))
        self._links += len(links)

    def _add(self, edge: Edge) -> None:
        self._graph.add_edge(edge.before, edge.after, edge.relative, edge.covariance, robust=edge.robust)


def _find_changes(points: Floats) -> tuple[Change, ...]:
    """Group points (n, 2) of walls that only one of two maps has by what lies together."""
    pairs: NDArray[np.intp] = cKDTree(points).query_pairs(_TOGETHER, output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    count, labels = connected_components(near, directed=False)
    places = sorted((points[labels == number] for number in range(count)), key=len, reverse=True)
    corners = [(each.min(axis=0), each.max(axis=0)) for each in places if len(each) >= _LEAST_CHANGE]
    return tuple(Change(*((low + high) / 2.0).tolist(), *(high - low + _COARSE).tolist()) for low, high in corners)
