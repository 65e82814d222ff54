"""Simultaneous localisation and mapping: scans in, the pose on the map and keyframes out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.map_state import Edge, Trail, find_drives, select_views
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import (
    LEAST_NOISE,
    POOR,
    ScanMatch,
    contradiction,
    locate_surface,
    position_deviation,
    rotate_covariance,
)
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats
from ur_nodes.slam.pose_graph.graph import PoseGraph
from ur_nodes.slam.pose_graph.loop_closer import LoopCloser
from ur_nodes.slam.prediction import UNKNOWN_MOTION, MotionPredictor

_PAIRS_AT_REST = 2  # of neighbouring keyframes that are matched instead of a scan at rest
_ORIGIN = Pose2(0.0, 0.0, 0.0)
_RADIUS = 5.0  # m: keyframes within are part of the local map,
_MOST_UNCERTAIN = 0.05  # m: as long as their place relative to the reference is so certain
_MEMBERS = 9  # keyframes at most
_JUST_MADE = 9  # keyframes, likewise: in a bare corridor none is certain, but its walls tell the heading
# A match
_LEAST_AGREEMENT = 0.35  # below, the scan gives no evidence
_CONTRADICTED = (0.5, 0.3)  # agreement below and contradiction above which the scan was taken elsewhere
_IN_SIGHT = 0.3  # share of the last scan that must be in sight of one that it explains
_CERTAIN = 0.03  # m: standard deviation of matches that teach, and that replace odometry
# Where a new keyframe is due, an old one may serve
_SEEN_AGAIN = 0.3  # m: so near to it
_CLEAR = 0.8  # agreement, at least
_UNCHANGED = (0.95, 0.02)  # least agreement and most contradiction of a place that has not changed
_REPLACED = 0.25  # rad: so near, its scan is replaced where the place has changed
_RETURN_NOISE = np.diag(np.square((0.01, 0.01, 0.004)))  # m, rad: of the match to it


@dataclass(frozen=True, slots=True)
class MapperSettings:
    """A keyframe is made after `distance` m or `turn` rad."""

    distance: float = 0.4
    turn: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class MapEstimate:
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


@dataclass(frozen=True, slots=True, eq=False)
class _Leg:
    """The drive since the robot's pose became known relative to `reference`, a keyframe.

    `start` is the robot's pose relative to it at the start, `odometry` that in the frame of odometry, None where there
    is none. `noise` (3, 3) is the covariance of odometry since then.
    """

    reference: int = 0
    start: Pose2 = _ORIGIN
    odometry: Pose2 | None = None
    noise: Floats = field(default_factory=lambda: np.zeros((3, 3)))


class ScanMapper:
    """Builds a map from successive scans. The same scans give the same map; `settings` may be replaced between two."""

    def __init__(self, settings: MapperSettings | None = None, *, cautious: bool = False, first: int = 0) -> None:
        """`cautious`: a scan that contradicts the map does not become part of it. `first` numbers the first scan."""
        self._cautious = cautious
        self.settings = settings or MapperSettings()
        self._graph = PoseGraph()
        self.scans: list[MapScan] = []  # of the keyframes
        self._trail = Trail()
        self._count = first  # of scans
        self._predictor = MotionPredictor()
        self._loops = LoopCloser(self._graph, self.scans)
        self._local: LocalMap | None = None
        self._changed = False  # what the local map is made of
        self._drive_start = 0  # the first keyframe of this drive
        self._leg = _Leg()
        self._relative = _ORIGIN  # pose at the last scan, relative to the leg's reference
        self._estimate: MapEstimate | None = None
        self._last_scan: MapScan | None = None  # that was matched

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

    def restore(self, poses: Sequence[Pose2], edges: Sequence[Edge], scans: Sequence[MapScan]) -> None:
        """Start with the keyframes of an existing map, at least one; `join` must follow."""
        for pose in poses:
            self._graph.add_pose(pose)
        for edge in edges:
            self._graph.add_edge(edge.before, edge.after, edge.relative, edge.covariance, robust=edge.robust)
        self.scans += scans
        self._drive_start = len(self.scans)

    def join(self, other: ScanMapper, place: Pose2, links: Sequence[Edge]) -> MapEstimate:
        """Take over the keyframes of another mapper, whose frame is at `place` on this map, and continue from its pose.

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
        self._drive_start = min(self._drive_start, first)
        self._leg = replace(other._leg, reference=other._leg.reference + first)
        self._relative, self._last_scan = other._relative, other._last_scan
        self._predictor.go_on_from(other._predictor)
        self._graph.optimise()
        self._changed = True
        self._loops.restart()
        self._loops.loops += len(links)
        last = other._estimate
        self._estimate = MapEstimate(self._pose(), last.covariance, last.agreement, located=True)
        return self._estimate

    def add_scan(self, scan: MapScan, odometry: Pose2 | None = None, heading: float | None = None) -> MapEstimate:
        """Take the next scan, with the pose of the robot in the frame of its odometry if there is any.

        `heading` (rad, from an arbitrary origin) replaces that of the odometry if two successive scans have one.
        """
        if not self.scans or (len(self.scans) == 1 and not len(self.scans[0].hits)):  # begin where there is something
            if not self.scans:
                self._graph.add_pose(_ORIGIN)
            self.scans[:] = [scan]
            self._leg = _Leg(odometry=odometry)
            self._predictor.add(odometry, heading)
            self._changed = True
            return self._remember(MapEstimate(_ORIGIN, LEAST_NOISE, 1.0, located=True))
        assert self._estimate is not None
        predicted = self._predictor.predict(odometry, heading)
        if predicted.still:
            self._changed |= self._loops.step(_PAIRS_AT_REST)
            return self._remember(replace(self._estimate, pose=self._pose(), located=True, still=True, step=None))
        spare = 0 if self._changed else 1  # a new local map takes time enough
        before = self._pose()
        guess, prior = before.compose(predicted.motion), rotate_covariance(predicted.covariance, -before.yaw)
        match = locate_surface(self._local_map(), scan.surface, guess, prior, before, UNKNOWN_MOTION)
        located = match.agreement >= _LEAST_AGREEMENT
        pose = match.pose if located else guess
        motion = before.inverse().compose(pose)
        self._predictor.add(odometry, heading, motion)
        self._leg = replace(self._leg, noise=self._leg.noise + predicted.covariance)
        contradicted = self._is_contradicted(scan, match)
        self._relative = self._graph.poses[self._leg.reference].inverse().compose(pose)
        self._last_scan = scan
        if not self._is_far(self._relative) or (contradicted and self._cautious):
            self._changed |= self._loops.step(spare)
        elif not self._return_to_keyframe(scan, match, odometry):
            self._add_keyframe(scan, pose, match.covariance, odometry, located)
        certain = match.agreement >= POOR and not contradicted and position_deviation(match.covariance) < _CERTAIN
        found = self._pose(), match.covariance, match.agreement, located, contradicted
        return self._remember(MapEstimate(*found, step=motion if certain else None, wheels=predicted.wheels))

    def _pose(self) -> Pose2:
        return self._graph.poses[self._leg.reference].compose(self._relative)

    def _remember(self, estimate: MapEstimate) -> MapEstimate:
        self._trail.add(self._count, self._leg.reference, self._relative)
        self._count += 1
        self._estimate = estimate
        return estimate

    # -- the pose on the map round the robot -----------------------------------------------------------------------

    def _is_contradicted(self, scan: MapScan, match: ScanMatch) -> bool:
        """Return whether a scan was taken elsewhere; after such a scan, the next one must clearly fit the map.

        A scan that contradicts the map but not the last scan was taken where a door has opened.
        """
        last = self._estimate
        if match.agreement >= (POOR if last and last.contradicted else _CONTRADICTED[0]):
            return False
        if last and last.contradicted:
            return True
        known = [(self._local_map().surface, 0.0)]
        if self._last_scan:
            known.append((self._last_scan.surface.moved(self._pose()), _IN_SIGHT))
        return all(contradiction(each, scan, match.pose, least) > _CONTRADICTED[1] for each, least in known)

    def _local_map(self) -> LocalMap:
        if self._changed or self._local is None:
            self._local = LocalMap([(self._graph.poses[each], self.scans[each].surface) for each in self._members()])
            self._changed = False
        return self._local

    def _members(self) -> list[int]:
        """Return the keyframes of the local map: near, certain or just made, and no two that show the same."""
        reference, here = self._leg.reference, self._pose()
        poses = np.array(self._graph.poses)
        gaps = np.hypot(poses[:, 0] - here.x, poses[:, 1] - here.y)
        certain = np.isfinite(self._graph.spread_from(reference, _MOST_UNCERTAIN))
        begun = max([0, *find_drives(self._graph.edges, reference + 1)])  # what was made before is a map of its own
        certain[max(begun, reference - _JUST_MADE) : reference] = True
        views = select_views(poses, [reference, *np.flatnonzero((gaps < _RADIUS) & certain).tolist()])
        return sorted(views, key=lambda number: float(gaps[number]))[:_MEMBERS]

    # -- keyframes and loops ---------------------------------------------------------------------------------------

    def _is_far(self, relative: Pose2) -> bool:
        moved = self._leg.start.inverse().compose(relative)
        far = math.hypot(moved.x, moved.y) >= self.settings.distance
        return far or abs(wrap_angle(moved.yaw)) >= self.settings.turn

    def _return_to_keyframe(self, scan: MapScan, match: ScanMatch, odometry: Pose2 | None) -> bool:
        """Continue from a nearby old keyframe of this drive; False if a new one is needed.

        A map thus grows with the mapped floor, not with the distance driven.
        """
        if match.agreement < _CLEAR or position_deviation(match.covariance) > _CERTAIN:
            return False
        places = np.array(self._graph.poses).reshape(-1, 3)
        gaps = np.hypot(places[:, 0] - match.pose.x, places[:, 1] - match.pose.y)
        gaps[: self._drive_start] = np.inf
        near = np.flatnonzero(gaps < _SEEN_AGAIN)
        if not len(near):
            return False
        certain = np.isfinite(self._graph.spread_from(self._leg.reference, _MOST_UNCERTAIN))
        near = near[certain[near]]
        if not len(near):
            return False
        number = int(near[np.argmin(gaps[near])])
        relative = self._graph.poses[number].inverse().compose(match.pose)
        against = contradiction(self._local_map().surface, scan, match.pose)
        if match.agreement < _UNCHANGED[0] or against > _UNCHANGED[1]:
            if abs(relative.yaw) > _REPLACED:
                return False
            self.scans[number] = scan.moved(relative)
        self._begin_leg(_Leg(number, relative, odometry, _RETURN_NOISE))
        return True

    def _begin_leg(self, leg: _Leg) -> None:
        self._leg, self._relative = leg, leg.start
        self._changed = True

    def _add_keyframe(
        self, scan: MapScan, pose: Pose2, covariance: Floats, odometry: Pose2 | None, located: bool
    ) -> None:
        """Add a scan at `pose` as a keyframe, and an edge from the reference: by the match and by odometry."""
        leg = self._leg
        relative = self._graph.poses[leg.reference].inverse().compose(pose)
        drift = rotate_covariance(leg.noise, relative.yaw) + LEAST_NOISE
        seen = rotate_covariance(covariance, pose.yaw) + LEAST_NOISE
        known = np.linalg.inv(np.linalg.inv(seen) + np.linalg.inv(drift)) if located else drift
        certain = located and position_deviation(covariance) < _CERTAIN
        if odometry is not None and leg.odometry is not None and certain:
            self._predictor.learn(leg.odometry.inverse().compose(odometry), leg.start.inverse().compose(relative))
        number = self._graph.add_pose(pose)
        self._graph.add_edge(leg.reference, number, relative, known, robust=False)
        self.scans.append(scan)
        self._begin_leg(_Leg(number, odometry=odometry))
        self._changed |= self._loops.add_keyframe(number)
