"""Simultaneous localisation and mapping: scans in, the pose on the map out, and keyframes to draw the map from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.correlative import Pyramid, Window, search
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import Match, match_surface
from ur_nodes.slam.matching.scan import Scan
from ur_nodes.slam.matching.surface import Floats
from ur_nodes.slam.odometry_model import OdometryModel, is_still, with_measured_turn
from ur_nodes.slam.pose_graph.edge import Edge
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loop_closer import LoopCloser
from ur_nodes.slam.pose_graph.loops import LEAST_NOISE, contradiction, turned
from ur_nodes.slam.pose_graph.trail import Trail

_AT_REST = 2  # pairs of neighbours that are matched with a scan that is not
_ROUND = 5.0  # m: keyframes within are part of the local map
_TRUSTED = 0.05  # m: as long as they are so certain
_MEMBERS = 9  # keyframes of the local map
_APART = (0.3, 0.6)  # m, rad: nearer ones show the same
_LOST = 0.35  # agreement below which the scan says nothing
_POOR = 0.6  # agreement below which a wider search is tried
_CONTRADICTED = (0.5, 0.3)  # agreement below and contradiction above which the scan was taken elsewhere
_SLIPPED = 2.5  # standard deviations of odometry: the scan says that the wheels slip
_SEEN_AGAIN = 0.3  # m: so near to an old keyframe a new one is not needed where nothing new is seen
_REPLACED = 0.25  # rad: so near, its scan is replaced where the place has changed
_CLEAR = 0.8  # agreement with which a scan can do so
_UNCHANGED = (0.95, 0.02)  # least agreement and most contradiction of a place that has not
_CERTAIN = 0.03  # m: matches that teach, and that replace odometry
_REFERRED = np.diag(np.square((0.01, 0.01, 0.004)))  # of a match to an old keyframe, m and rad
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
    scan before, so that this one was not matched. `step` is the motion since then where the scan shows it for certain,
    `wheels` the same motion by odometry, its lasting errors corrected.
    """

    pose: Pose2
    covariance: Floats
    agreement: float
    located: bool
    contradicted: bool = False
    still: bool = False
    step: Pose2 | None = None
    wheels: Pose2 | None = None


class Mapper:
    """Builds a map from scans that come one after the other. The same scans give the same map."""

    def __init__(self, settings: MapperSettings | None = None, *, cautious: bool = False, first: int = 0) -> None:
        """`cautious`: a scan that contradicts the map does not become part of it. `first` numbers the first scan."""
        self._cautious = cautious
        self._settings = settings or MapperSettings()
        self._graph = PoseGraph()
        self.scans: list[Scan] = []  # of the keyframes
        self._trail = Trail()
        self._count = first  # of scans
        self._model = OdometryModel()
        self._local: LocalMap | None = None
        self._pyramid: Pyramid | None = None
        self._loops = LoopCloser(self._graph, self.scans)
        self._changed = False
        self._reference = 0  # the keyframe that poses are known relative to
        self._first = 0  # keyframe of this drive
        self._relative = Pose2(0.0, 0.0, 0.0)  # of the last scan, to the reference
        self._leg = Pose2(0.0, 0.0, 0.0)  # of the scan where it became the reference
        self._step = Pose2(0.0, 0.0, 0.0)  # between the last two scans
        self._odometry: Pose2 | None = None  # at the last scan
        self._heading: float | None = None  # there
        self._leg_odometry: Pose2 | None = None  # there
        self._motion_noise = np.zeros((3, 3))  # of odometry since
        self._estimate: Estimate | None = None

    @property
    def keyframes(self) -> list[Pose2]:
        """The poses of all keyframes; those of `scans`."""
        return self._graph.poses

    @property
    def edges(self) -> Sequence[Edge]:
        """The edges of the pose graph."""
        return self._graph.edges

    @property
    def loops(self) -> int:
        """The number of edges that join places seen again."""
        return self._loops.loops

    def path(self) -> dict[int, Pose2]:
        """The pose at every scan so far, by its number, as is known now."""
        return self._trail.path(self._graph.poses)

    def restore(self, poses: Sequence[Pose2], edges: Sequence[Edge], scans: Sequence[Scan]) -> None:
        """Begin with the keyframes of a map that was made before, at least one; `join` must follow."""
        for pose in poses:
            self._graph.add_pose(pose)
        for edge in edges:
            self._graph.add_edge(edge.before, edge.after, edge.relative, edge.covariance, robust=edge.robust)
        self.scans += scans
        self._first = len(self.scans)

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
            self._graph.add_edge(*ends, edge.relative, edge.covariance + LEAST_NOISE, robust=True)
        self.scans += other.scans
        self._trail.extend(other._trail, first)
        self._count = other._count
        self._reference = other._reference + first
        self._first = min(self._first, first)
        self._relative, self._leg, self._step = other._relative, other._leg, other._step
        self._odometry, self._leg_odometry, self._heading = other._odometry, other._leg_odometry, other._heading
        self._motion_noise = other._motion_noise
        self._graph.optimise()
        self._changed = True
        self._loops.restart()
        self._loops.loops += len(links)
        last = other._estimate
        self._estimate = Estimate(self._pose(), last.covariance, last.agreement, located=True)
        return self._estimate

    def add_scan(self, scan: Scan, odometry: Pose2 | None = None, heading: float | None = None) -> Estimate:
        """Take the next scan, with the pose of the robot in the frame of its odometry if there is any.

        `heading` (rad, from any begin) counts instead of that of the odometry where two scans in a row have one.
        """
        if not self.scans:
            return self._begin(scan, odometry, heading)
        assert self._estimate is not None
        wheels, noise, still = self._predict(odometry)
        motion = wheels
        if heading is not None and self._heading is not None and self._odometry is not None:
            motion, noise = with_measured_turn(wheels, noise, heading - self._heading)
        before = self._pose()
        guess = before.compose(motion)
        if still:
            self._changed |= self._loops.step(_AT_REST)
            return self._remember(replace(self._estimate, pose=self._pose(), located=True, still=True, step=None))
        prior = turned(noise, -before.yaw)
        spare = 0 if self._changed else 1  # a new local map takes time enough
        match = self._locate(scan, guess, prior, before)
        located = match.agreement >= _LOST
        pose = match.pose if located else guess
        self._step = before.inverse().compose(pose)
        self._odometry, self._heading = odometry, heading
        self._motion_noise = self._motion_noise + noise
        self._relative = self._graph.poses[self._reference].inverse().compose(pose)
        contradicted = self._is_contradicted(scan, match)
        if not self._is_far(self._relative) or (contradicted and self._cautious):
            self._changed |= self._loops.step(spare)
        elif not self._return_to_keyframe(scan, match, odometry):
            self._add_keyframe(scan, pose, match.covariance, odometry, located)
        shown = match.agreement >= _POOR and not contradicted and _spread(match.covariance) < _CERTAIN
        step = self._step if shown else None
        return self._remember(
            Estimate(self._pose(), match.covariance, match.agreement, located, contradicted, False, step, wheels)
        )

    def _begin(self, scan: Scan, odometry: Pose2 | None, heading: float | None) -> Estimate:
        self._graph.add_pose(Pose2(0.0, 0.0, 0.0))
        self.scans.append(scan)
        self._odometry = self._leg_odometry = odometry
        self._heading = heading
        self._changed = True
        return self._remember(Estimate(Pose2(0.0, 0.0, 0.0), LEAST_NOISE, 1.0, located=True))

    def _pose(self) -> Pose2:
        return self._graph.poses[self._reference].compose(self._relative)

    def _remember(self, estimate: Estimate) -> Estimate:
        self._trail.add(self._count, self._reference, self._relative)
        self._count += 1
        self._estimate = estimate
        return estimate

    def _predict(self, odometry: Pose2 | None) -> tuple[Pose2, Floats, bool]:
        """The motion since the last scan, its covariance (3, 3) in the frame before it, and whether there was none."""
        if odometry is None or self._odometry is None:
            return self._step, _UNKNOWN_MOTION, False
        reported = self._odometry.inverse().compose(odometry)
        return self._model.correct(reported), self._model.covariance(reported), is_still(reported)

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
        spread = self._graph.spread_from(self._reference, _TRUSTED)
        places = np.array(poses)
        gaps = np.hypot(places[:, 0] - here.x, places[:, 1] - here.y)
        chosen: list[int] = [self._reference]
        for number in np.flatnonzero((gaps < _ROUND) & np.isfinite(spread)).tolist():
            shift = np.hypot(*(places[chosen, :2] - places[number, :2]).T)
            swing = np.abs(np.remainder(places[chosen, 2] - places[number, 2] + math.pi, 2 * math.pi) - math.pi)
            if not np.any((shift < _APART[0]) & (swing < _APART[1])):
                chosen.append(number)
        return sorted(chosen, key=lambda number: float(gaps[number]))[:_MEMBERS]

    # -- keyframes and loops ---------------------------------------------------------------------------------------

    def _is_far(self, relative: Pose2) -> bool:
        moved = self._leg.inverse().compose(relative)
        far = math.hypot(moved.x, moved.y) >= self._settings.distance
        return far or abs(wrap_angle(moved.yaw)) >= self._settings.turn

    def _return_to_keyframe(self, scan: Scan, match: Match, odometry: Pose2 | None) -> bool:
        """Go on from an old keyframe of this drive where there is one near by; False: a new one is needed.

        So a map grows with the floor that was seen, not with the way driven.
        """
        if match.agreement < _CLEAR or _spread(match.covariance) > _CERTAIN:
            return False
        places = np.array(self._graph.poses[self._first :]).reshape(-1, 3)
        gaps = np.hypot(places[:, 0] - match.pose.x, places[:, 1] - match.pose.y)
        near = np.flatnonzero(gaps < _SEEN_AGAIN) + self._first
        if not len(near):
            return False
        near = near[np.isfinite(self._graph.spread_from(self._reference, _TRUSTED)[near])]
        if not len(near):
            return False
        number = int(near[np.argmin(gaps[near - self._first])])
        relative = self._graph.poses[number].inverse().compose(match.pose)
        against = contradiction(self._local_map().surface, scan, match.pose)
        if match.agreement < _UNCHANGED[0] or against > _UNCHANGED[1]:
            if abs(relative.yaw) > _REPLACED:
                return False
            self.scans[number] = scan.moved(relative)
        self._refer_to(number, relative, odometry, _REFERRED)
        return True

    def _refer_to(self, number: int, relative: Pose2, odometry: Pose2 | None, noise: Floats) -> None:
        self._reference = number
        self._relative = self._leg = relative
        self._leg_odometry = odometry
        self._motion_noise = noise
        self._changed = True

    def _add_keyframe(self, scan: Scan, pose: Pose2, covariance: Floats, odometry: Pose2 | None, located: bool) -> None:
        before = self._reference
        relative = self._graph.poses[before].inverse().compose(pose)
        drift = turned(self._motion_noise, relative.yaw) + LEAST_NOISE
        seen = turned(covariance, pose.yaw) + LEAST_NOISE
        known = np.linalg.inv(np.linalg.inv(seen) + np.linalg.inv(drift)) if located else drift
        certain = located and _spread(covariance) < _CERTAIN
        if odometry is not None and self._leg_odometry is not None and certain:
            self._model.learn(self._leg_odometry.inverse().compose(odometry), self._leg.inverse().compose(relative))
        number = self._graph.add_pose(pose)
        self._graph.add_edge(before, number, relative, known, robust=False)
        self.scans.append(scan)
        self._refer_to(number, Pose2(0.0, 0.0, 0.0), odometry, np.zeros((3, 3)))
        self._changed |= self._loops.look_round(number)


def _spread(covariance: Floats) -> float:
    """The standard deviation (m) along the direction that is known least."""
    return math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1]))
