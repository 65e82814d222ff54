"""Loop candidates: places to check, and whether a scan was taken there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.contradiction import contradiction
from ur_nodes.slam.matching.correlative import Window, Work, search_slowly
from ur_nodes.slam.matching.covariance import rotate_covariance
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import ScanMatch, match_surface
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats

RECENT = 12
"""Keyframes before the newest one that it is no loop to see again."""

_NEAR = 2.5  # m: keyframes so near see the same things, as a rule
_GROUP = 7  # keyframes
_MOST_GROUPS = 2
_SURE = 0.12  # m: with less uncertainty the scan is matched from where it is
_WIDEST = Window(8.0, 0.5)
_POINTS = 150  # of a scan, in a search
_LEAST_SCORE = 0.55
_RIVAL = 0.85  # of the best score: another place that fits as well
_LEAST_AGREEMENT = 0.6
_MOST_CONTRADICTION = 0.15
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
    """The pose of keyframe `after` in the frame of `before`; not `sure`: it needs confirmation by another one."""

    before: int
    after: int
    relative: Pose2
    covariance: Floats
    sure: bool
    correction: Pose2


def find_groups(poses: Sequence[Pose2], number: int, spread: NDArray[np.float64], last: int) -> list[KeyframeGroup]:
    """Choose groups of the keyframes before `last` that keyframe `number` may see, the nearest first.

    `spread` (n) is how uncertain their places are relative to it, m; those with inf are left out.
    """
    if last <= 0:
        return []
    places = np.array([pose[:2] for pose in poses[:last]])
    gaps = np.hypot(*(places - poses[number][:2]).T)
    known = np.isfinite(spread[:last])
    within = np.flatnonzero(known & (gaps < _NEAR + np.minimum(3.0 * spread[:last], _WIDEST.shift)))
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
    group: KeyframeGroup, number: int, poses: Sequence[Pose2], scans: Sequence[MapScan]
) -> Work[PoseLink | None]:
    """Match the scan of a keyframe to a group; None when it was not taken there, or may have been taken elsewhere.

    The poses must not change meanwhile.
    """
    placed = [(poses[member], scans[member].surface) for member in group.members]
    target = LocalMap(placed)
    scan, guess = scans[number], poses[number]
    start = guess
    sure = group.spread < _SURE
    if not sure:
        window = Window(min(_WIDEST.shift, 3.0 * group.spread + 0.2), min(_WIDEST.turn, group.spread + 0.1))
        yield _COST_OF_MAP
        found = yield from search_slowly(target.pyramid, scan.surface.sample(_POINTS), guess, window, _LEAST_SCORE)
        if found is None or found.rival > _RIVAL * found.score:
            return None
        start = found.pose
    yield _COST_OF_MAP
    match = match_surface(target, scan.surface, start)
    if not _fits(match, start, target, scan):
        return None
    anchor = poses[group.anchor]
    return PoseLink(
        group.anchor,
        number,
        anchor.inverse().compose(match.pose),
        rotate_covariance(match.covariance, match.pose.yaw),
        sure,
        match.pose.compose(guess.inverse()),
    )


def agree(one: PoseLink, other: PoseLink, pose: Pose2) -> bool:
    """Test two links for the same correction of a pose on the map."""
    a, b = one.correction.compose(pose), other.correction.compose(pose)
    return math.hypot(a.x - b.x, a.y - b.y) < _AGREEMENT[0] and abs(wrap_angle(a.yaw - b.yaw)) < _AGREEMENT[1]


def _fits(match: ScanMatch, start: Pose2, target: LocalMap, scan: MapScan) -> bool:
    moved = math.hypot(match.pose.x - start.x, match.pose.y - start.y)
    return (
        match.agreement >= _LEAST_AGREEMENT
        and moved < _MOST_MOVED
        and contradiction(target.surface, scan, match.pose) <= _MOST_CONTRADICTION
    )
