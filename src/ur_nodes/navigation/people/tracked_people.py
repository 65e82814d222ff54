"""People for the local planner: discs at constant velocity, and their clearance to the robot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.hull import Hull, hull_of_outline
from ur_nodes.geometry.pose import Pose2

Floats = NDArray[np.float64]

MARGIN = 0.29
"""Room between the robot and a person that it keeps while it moves, m."""

_SLACK, _LEAST_SLACK = 0.02, 0.002  # m: a motion that loses less than this brings the robot no nearer
_CLOSEST = 0.265  # m to a person from where on only the least counts as none: each period may lose it again
_HORIZON = 1.0  # s ahead: the robot stops within half of it, and people do not keep their course for longer
_SUDDEN, _SUDDEN_MARGIN = 0.4, 0.27  # s ahead and m: where they are now counts, too, as they may stop
_REACH, _STANDING = 3.0, 0.3  # m to people who matter within that time, and m/s: slower people stand


@dataclass(frozen=True, slots=True, eq=False)
class TrackedPeople:
    """People in the odometry frame: places (n, 2) in m, velocities (n, 2) in m/s, and radii (n) in m."""

    points: Floats
    velocities: Floats
    radii: Floats

    @property
    def standing(self) -> TrackedPeople:
        """The people who stand."""
        kept = np.hypot(*self.velocities.T) < _STANDING
        return TrackedPeople(self.points[kept], self.velocities[kept], self.radii[kept])

    def near(self, pose: Pose2) -> TrackedPeople:
        """Return the people who may come near a robot at a pose within the prediction horizon."""
        kept = np.hypot(*(self.points - pose[:2]).T) < _REACH
        return TrackedPeople(self.points[kept], self.velocities[kept], self.radii[kept])


NO_PEOPLE = TrackedPeople(np.empty((0, 2)), np.empty((0, 2)), np.empty(0))


def approaches(
    poses: Floats, times: Floats, start: Pose2, people: TrackedPeople, footprint: Footprint
) -> NDArray[np.bool_]:
    """Mark the poses (t, k, 3) at times (t) in s that bring the robot nearer to a person than MARGIN.

    People go on at constant velocity, and may stop at once. Where one comes that near to a robot that stays at `start`,
    only what loses more room than that counts: the robot may leave, and it may not drive towards them.
    """
    people = people.near(start)
    nearer = np.zeros(poses.shape[:2], bool)
    soon = int(np.searchsorted(times, _HORIZON + 1e-9))
    if not len(people.points) or not soon:
        return nearer
    poses, times = poses[:soon], times[:soon]
    hull = hull_of_footprint(footprint)
    then = people.points + times[:, None, None] * people.velocities  # (t, n, 2)
    rooms = rooms_to(hull, poses, then[:, None]) - people.radii
    stayed = rooms_to(hull, np.array(start), then)[:, None] - people.radii
    nearer[:soon] = (rooms < np.minimum(MARGIN, _without_slack(stayed))).any(axis=-1)
    brief = int(np.searchsorted(times, _SUDDEN + 1e-9))
    rooms = rooms_to(hull, poses[:brief], people.points) - people.radii
    stayed = rooms_to(hull, np.array(start), people.points) - people.radii
    nearer[:brief] |= (rooms < np.minimum(_SUDDEN_MARGIN, _without_slack(stayed))).any(axis=-1)
    return nearer


def _without_slack(rooms: Floats) -> Floats:
    slack: Floats = np.clip(rooms - _CLOSEST, _LEAST_SLACK, _SLACK)
    return rooms - slack


def rooms_to(hull: Hull, poses: Floats, points: Floats) -> Floats:
    """Return the clearance (..., n) in m between the hull at poses (..., 3) and points (..., n, 2)."""
    poses = poses[..., None, :]
    dx, dy = points[..., 0] - poses[..., 0], points[..., 1] - poses[..., 1]
    c, s = np.cos(poses[..., 2]), np.sin(poses[..., 2])
    local = np.stack((c * dx + s * dy, c * dy - s * dx), axis=-1)
    return hull.distances(local.reshape(-1, 2)).reshape(local.shape[:-1])


def room_to_people(pose: Pose2, people: TrackedPeople, footprint: Footprint) -> float:
    """Return the clearance in m between the robot at a pose and the nearest person; inf without people."""
    near = people.near(pose)
    return float((rooms_to(hull_of_footprint(footprint), np.array(pose), near.points) - near.radii).min(initial=np.inf))


def leads_to_standing(path: Floats, people: TrackedPeople, footprint: Footprint) -> bool:
    """Return whether a path (n, 2) leads nearer than MARGIN to a person at rest."""
    standing = people.standing
    gaps = np.hypot(*np.moveaxis(path[:, None] - standing.points, -1, 0)) - standing.radii
    return bool((gaps < footprint.inscribed + MARGIN).any())


@lru_cache(maxsize=8)
def hull_of_footprint(footprint: Footprint) -> Hull:
    """Return the convex hull of the outline."""
    return hull_of_outline([(x, y) for x, y in footprint.outline.tolist()])
