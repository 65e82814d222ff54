import math

import numpy as np
from tests.ur_nodes.slam.rooms import ROOM, box, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loop_closer import NeighbourMatcher

KNOWN = np.square((0.02, 0.02, 0.01))
TRUTH = [Pose2(0.4 * n - 1.5, 0.3 * math.sin(n), 0.1 * n) for n in range(10)]
SCANS = [scan_at(ROOM, pose, 0.01, number) for number, pose in enumerate(TRUTH)]


def chain(noise: float = 1.0) -> PoseGraph:
    """Keyframes at `TRUTH`, each tied to the one before it by an edge that is wrong, with so many times the noise."""
    random = np.random.default_rng(2)
    graph = PoseGraph()
    graph.add_pose(TRUTH[0])
    for number in range(1, len(TRUTH)):
        error = Pose2(*random.normal(0.0, np.sqrt(KNOWN)).tolist())
        relative = TRUTH[number - 1].inverse().compose(TRUTH[number]).compose(error)
        graph.add_pose(graph.poses[-1].compose(relative))
        graph.add_edge(number - 1, number, relative, noise * noise * np.diag(KNOWN), robust=False)
    return graph


def match_all(graph: PoseGraph, scans: list[MapScan]) -> NeighbourMatcher:
    matcher = NeighbourMatcher(graph, scans)
    matcher.add_all()
    finish(matcher)
    return matcher


def finish(matcher: NeighbourMatcher) -> None:
    for _ in range(100):
        matcher.step()


def error(graph: PoseGraph) -> float:
    return max(math.dist(found[:2], true[:2]) for found, true in zip(graph.poses, TRUTH, strict=True))


def test_edges_between_neighbours_straighten_a_chain() -> None:
    graph = chain()
    before = error(graph)
    match_all(graph, SCANS)
    assert graph.unsettled
    while graph.unsettled:
        graph.step()
    assert before > 0.05
    assert error(graph) < 0.25 * before


def test_edges_only_count_where_others_do_not_contradict_them() -> None:
    graph = chain()
    match_all(graph, SCANS)
    assert all(edge.robust for edge in graph.edges[len(TRUTH) - 1 :])


def test_no_two_keyframes_are_matched_twice() -> None:
    graph = chain()
    matcher = match_all(graph, SCANS)
    count = len(graph.edges)
    matcher.add_all()
    finish(matcher)
    matcher.restart()
    finish(matcher)
    assert len(graph.edges) == count
    assert not matcher.step()


def test_new_keyframe_is_matched_before_those_that_wait() -> None:
    graph = chain()
    matcher = NeighbourMatcher(graph, SCANS)
    matcher.add_all()
    for number in range(len(SCANS)):
        matcher.add(number)
    matcher.step()
    assert len(SCANS) - 1 in graph.edges[-1][:2]


def test_keyframes_whose_places_are_uncertain_are_not_matched() -> None:
    graph = chain(10.0)
    match_all(graph, SCANS)
    assert len(graph.edges) == len(TRUTH) - 1


def test_keyframes_that_see_nothing_or_another_room_are_not_matched() -> None:
    elsewhere = walls_of(box(-9.0, -7.0, 8.0, 8.5))
    scans = [scan_at(elsewhere if n % 2 else ROOM, pose, reach=0.11 if n > 5 else 12.0) for n, pose in enumerate(TRUTH)]
    graph = chain()
    match_all(graph, scans)
    added = graph.edges[len(TRUTH) - 1 :]
    assert added
    assert all(edge.before % 2 == edge.after % 2 and max(edge[:2]) <= 5 for edge in added)
