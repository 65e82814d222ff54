"""Simultaneous localisation and mapping: scans in, the pose on the map out, and keyframes to draw the map from."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.correlative import Pyramid, Window, search
from ur_nodes.slam.edge import Edge
from ur_nodes.slam.graph import PoseGraph
from ur_nodes.slam.local_map import LocalMap
from ur_nodes.slam.loops import Group, Link, agree, contradiction, find_groups, turned, verify_group
from ur_nodes.slam.match import Match, match_surface
from ur_nodes.slam.odometry_model import OdometryModel
from ur_nodes.slam.scan import Scan
from ur_nodes.slam.surface import Floats

_STILL = (0.002, 0.002)  # m, rad: odometry that reports less motion means that the robot stands
_ROUND = 5.0  # m: keyframes within are part of the local map
_TRUSTED = 0.05  # m: as long as they are so certain
_MEMBERS = 9  # keyframes of the local map
_APART = (0.3, 0.6)  # m, rad: nearer ones show the same
_LOST = 0.35  # agreement below which the scan says nothing
_POOR = 0.6  # agreement below which a wider search is tried
_CONTRADICTED = (0.5, 0.3)  # agreement below and contradiction above which the scan was taken elsewhere
_SLIPPED = 2.5  # standard deviations of odometry: the scan says that the wheels slip
_LONGEST = 20.0  # m: places that are less certain are not looked at
_BACKLOG = 2  # places that may wait to be looked at when a keyframe is made
_DOUBTFUL = 24  # keyframes for which a loop waits for confirmation
_LEAST = np.diag(np.square((0.002, 0.002, 0.0007)))  # of an edge, m and rad: what no covariance knows
_UNKNOWN_MOTION = np.diag(np.square((0.1, 0.1, 0.15)))  # a scan later, without odometry


@dataclass(frozen=True, slots=True)
class MapperSettings:
    """A keyframe is made after `distance` m or `turn` rad."""

    distance: float = 0.4
    turn: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The robot's pose on the map after a scan, with its covariance (3, 3) relative to the map round it.

    `agreement` (0..1) is the share of the scan that lies on the map; `located`: whether it was enough. `contradicted`:
    little of the scan lies on the map, and its beams pass through walls. `still`: the robot has not moved since the
    scan before, so that this one was not matched.
    """

    pose: Pose2
    covariance: Floats
    agreement: float
    located: bool
    contradicted: bool = False
    still: bool = False


class Mapper:
    """Builds a map from scans that come one after the other. The same scans give the same map."""

    def __init__(self, settings: MapperSettings | None = None, *, cautious: bool = False) -> None:
        """`cautious`: a scan that contradicts the map does not become part of it."""
        self._cautious = cautious
        self._settings = settings or MapperSettings()
        self._graph = PoseGraph()
        self.scans: list[Scan] = []  # of the keyframes
        self._trail: list[tuple[int, Pose2]] = []  # keyframe and pose relative to it, of every scan
        self._model = OdometryModel()
        self._local: LocalMap | None = None
        self._pyramid: Pyramid | None = None
        self._work: deque[tuple[int, Group]] = deque()
        self._doubtful: list[Link] = []
        self._changed = False
        self._relative = Pose2(0.0, 0.0, 0.0)  # of the last scan, to the newest keyframe
        self._step = Pose2(0.0, 0.0, 0.0)  # between the last two scans
        self._odometry: Pose2 | None = None  # at the last scan
        self._keyframe_odometry: Pose2 | None = None
        self._motion_noise = np.zeros((3, 3))  # of odometry since the newest keyframe
        self._estimate: Estimate | None = None
        self.loops = 0

    @property
    def keyframes(self) -> list[Pose2]:
        """The poses of all keyframes; those of `scans`."""
        return self._graph.poses

    @property
    def edges(self) -> Sequence[Edge]:
        """The edges of the pose graph."""
        return self._graph.edges

    def path(self) -> list[Pose2]:
        """The pose at every scan so far, as is known now."""
        poses = self._graph.poses
        return [poses[number].compose(relative) for number, relative in self._trail]

    def restore(self, poses: Sequence[Pose2], edges: Sequence[Edge], scans: Sequence[Scan]) -> None:
        """Begin with the keyframes of a map that was made before, at least one; `join` must follow."""
        for pose in poses:
            self._graph.add_pose(pose)
        for edge in edges:
            self._graph.add_edge(edge.before, edge.after, edge.relative, edge.covariance, robust=edge.robust)
        self.scans += scans

    def join(self, other: Mapper, place: Pose2, links: Sequence[Edge]) -> Estimate:
        """Take over the keyframes of another mapper, whose frame lies at `place` on this map, and go on from its pose.

        `links`, at least one, are edges from keyframes of this map to keyframes of the other one, by its numbers.
        """
        assert other._estimate is not None
        first = len(self.scans)
        for pose in other.keyframes:
            self._graph.add_pose(place.compose(pose))
        for edge in other.edges:
            ends = edge.before + first, edge.after + first
            self._graph.add_edge(*ends, edge.relative, edge.covariance, robust=edge.robust)
        for edge in links:
            ends = edge.before, edge.after + first
            self._graph.add_edge(*ends, edge.relative, edge.covariance + _LEAST, robust=True)
        self.scans += other.scans
        self._trail += [(number + first, relative) for number, relative in other._trail]
        self._relative, self._step = other._relative, other._step
        self._odometry, self._keyframe_odometry = other._odometry, other._keyframe_odometry
        self._motion_noise = other._motion_noise
        self._work.clear()
        self._doubtful.clear()
        self._graph.optimise()
        self._changed = True
        self.loops += len(links)
        last = other._estimate
        self._estimate = Estimate(self._pose(), last.covariance, last.agreement, located=True)
        return self._estimate

    def add_scan(self, scan: Scan, odometry: Pose2 | None = None) -> Estimate:
        """Take the next scan, with the pose of the robot in the frame of its odometry if there is any."""
        if not self.scans:
            return self._begin(scan, odometry)
        assert self._estimate is not None
        motion, noise, still = self._predict(odometry)
        before = self._pose()
        guess = before.compose(motion)
        if still:
            self._do_some_work()
            return self._remember(replace(self._estimate, pose=self._pose(), located=True, still=True))
        prior = turned(noise, -before.yaw)
        match = self._locate(scan, guess, prior, before)
        located = match.agreement >= _LOST
        pose = match.pose if located else guess
        self._step = before.inverse().compose(pose)
        self._odometry = odometry
        self._motion_noise = self._motion_noise + noise
        newest = self._graph.poses[-1]
        self._relative = newest.inverse().compose(pose)
        contradicted = self._is_contradicted(scan, match)
        if self._is_far(self._relative) and not (contradicted and self._cautious):
            self._add_keyframe(scan, pose, match.covariance, odometry, located)
        else:
            self._do_some_work()
        return self._remember(Estimate(self._pose(), match.covariance, match.agreement, located, contradicted))

    def _begin(self, scan: Scan, odometry: Pose2 | None) -> Estimate:
        self._graph.add_pose(Pose2(0.0, 0.0, 0.0))
        self.scans.append(scan)
        self._odometry = self._keyframe_odometry = odometry
        self._changed = True
        return self._remember(Estimate(Pose2(0.0, 0.0, 0.0), _LEAST, 1.0, located=True))

    def _pose(self) -> Pose2:
        return self._graph.poses[-1].compose(self._relative)

    def _remember(self, estimate: Estimate) -> Estimate:
        self._trail.append((len(self.scans) - 1, self._relative))
        self._estimate = estimate
        return estimate

    def _predict(self, odometry: Pose2 | None) -> tuple[Pose2, Floats, bool]:
        """The motion since the last scan, its covariance (3, 3) in the frame before it, and whether there was none."""
        if odometry is None or self._odometry is None:
            return self._step, _UNKNOWN_MOTION, False
        reported = self._odometry.inverse().compose(odometry)
        still = math.hypot(reported.x, reported.y) < _STILL[0] and abs(reported.yaw) < _STILL[1]
        return self._model.correct(reported), self._model.covariance(reported), still

    # -- the pose on the map round the robot -----------------------------------------------------------------------

    def _locate(self, scan: Scan, guess: Pose2, prior: Floats, before: Pose2) -> Match:
        """Match a scan from a guess; where odometry seems to be wrong also from the pose `before`, and all round."""
        local = self._local_map()
        match = match_surface(local, scan.surface, guess, prior)
        surprise = np.array(guess.inverse().compose(match.pose))
        slipped = float(surprise @ np.linalg.solve(turned(prior, guess.yaw), surprise)) > _SLIPPED**2
        if slipped or match.agreement < _POOR:
            other = match_surface(local, scan.surface, before, _UNKNOWN_MOTION)
            if other.agreement > match.agreement:
                match = other
        if match.agreement >= _POOR or len(scan.surface) < 20:
            return match
        if self._pyramid is None:
            self._pyramid = Pyramid(local.surface.points)
        shift, turn = 3.0 * math.sqrt(prior[0, 0] + prior[1, 1]), 3.0 * math.sqrt(prior[2, 2])
        points = scan.surface.points[:: max(1, len(scan.surface) // 150)]
        found = search(self._pyramid, points, guess, Window(max(0.2, shift), max(0.1, turn)))
        if found is None:
            return match
        other = match_surface(local, scan.surface, found.pose, 4.0 * prior)
        return other if other.agreement > match.agreement + 0.05 else match

    def _is_contradicted(self, scan: Scan, match: Match) -> bool:
        """Tell whether a scan was taken elsewhere; once one was, the next must clearly lie on the map."""
        last = self._estimate
        if match.agreement >= (_POOR if last and last.contradicted else _CONTRADICTED[0]):
            return False
        if last and last.contradicted:
            return True
        return contradiction(self._local_map().surface, scan, match.pose) > _CONTRADICTED[1]

    def _local_map(self) -> LocalMap:
        if self._changed or self._local is None:
            placed = [(self._graph.poses[number], self.scans[number].surface) for number in self._members()]
            self._local, self._pyramid, self._changed = LocalMap(placed), None, False
        return self._local

    def _members(self) -> list[int]:
        """The keyframes that the local map is made of: near, certain, and no two that show the same."""
        poses, here = self._graph.poses, self._pose()
        spread = self._graph.spread_from(len(poses) - 1, _TRUSTED)
        places = np.array(poses)
        gaps = np.hypot(places[:, 0] - here.x, places[:, 1] - here.y)
        chosen: list[int] = [len(poses) - 1]
        for number in np.flatnonzero((gaps < _ROUND) & np.isfinite(spread))[:-1].tolist():
            shift = np.hypot(*(places[chosen, :2] - places[number, :2]).T)
            swing = np.abs(np.remainder(places[chosen, 2] - places[number, 2] + math.pi, 2 * math.pi) - math.pi)
            if not np.any((shift < _APART[0]) & (swing < _APART[1])):
                chosen.append(number)
        return sorted(chosen, key=lambda number: float(gaps[number]))[:_MEMBERS]

    # -- keyframes and loops ---------------------------------------------------------------------------------------

    def _is_far(self, relative: Pose2) -> bool:
        far = math.hypot(relative.x, relative.y) >= self._settings.distance
        return far or abs(wrap_angle(relative.yaw)) >= self._settings.turn

    def _add_keyframe(self, scan: Scan, pose: Pose2, covariance: Floats, odometry: Pose2 | None, located: bool) -> None:
        before = len(self.scans) - 1
        relative = self._graph.poses[before].inverse().compose(pose)
        drift = turned(self._motion_noise, relative.yaw) + _LEAST
        seen = turned(covariance, pose.yaw) + _LEAST
        known = np.linalg.inv(np.linalg.inv(seen) + np.linalg.inv(drift)) if located else drift
        certain = located and math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1])) < 0.03
        if odometry is not None and self._keyframe_odometry is not None and certain:
            self._model.learn(self._keyframe_odometry.inverse().compose(odometry), relative)
        self._keyframe_odometry = odometry
        self._motion_noise = np.zeros((3, 3))
        number = self._graph.add_pose(pose)
        self._graph.add_edge(before, number, relative, known, robust=False)
        self.scans.append(scan)
        self._relative = Pose2(0.0, 0.0, 0.0)
        self._changed = True
        while len(self._work) > _BACKLOG:
            self._do_some_work()
        spread = self._graph.spread_from(number, _LONGEST)
        self._work.extend((number, group) for group in find_groups(self._graph.poses, number, spread))

    def _do_some_work(self) -> None:
        """Look at one place that may have been seen before."""
        if not self._work:
            return
        number, group = self._work.popleft()
        link = verify_group(group, number, self._graph.poses, self.scans)
        if link is None:
            return
        links = [link] if link.sure else self._confirmed(link)
        for each in links:
            self._graph.add_edge(each.before, each.after, each.relative, each.covariance + _LEAST, robust=True)
        if links:
            self.loops += len(links)
            self._graph.optimise()
            self._changed = True

    def _confirmed(self, link: Link) -> list[Link]:
        """The link and those that wait and agree with it; none, and it waits, when there is no such."""
        self._doubtful = [each for each in self._doubtful if link.after - each.after <= _DOUBTFUL]
        place = self._graph.poses[link.after]
        friends = [each for each in self._doubtful if each.after != link.after and agree(each, link, place)]
        self._doubtful.append(link)
        if not friends:
            return []
        self._doubtful = [each for each in self._doubtful if each is not link and each not in friends]
        return [*friends, link]
