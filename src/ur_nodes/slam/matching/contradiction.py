"""Walls that a scan passes through: evidence that it was taken elsewhere, beyond the agreement of its points."""

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Surface

_THROUGH = 0.3  # m: a beam that passes a wall by so much contradicts it
_WIDEST_GAP = 0.05  # rad: what lies between beams farther apart is not in sight


def contradiction(target: Surface, scan: MapScan, pose: Pose2) -> float:
    """The share (0..1) of a map's points in sight of a scan at `pose` that its beams pass through.

    1 for a scan of fewer than two points, 0 where nothing of the map is in sight.
    """
    inside = target.moved(pose.inverse())
    delta = inside.points - scan.origin
    ends = scan.surface.points - scan.origin
    if len(ends) < 2:
        return 1.0
    angles, ranges = np.arctan2(ends[:, 1], ends[:, 0]), np.hypot(*ends.T)
    order = np.argsort(angles)
    angles, ranges = angles[order], ranges[order]
    bearing, distance = np.arctan2(delta[:, 1], delta[:, 0]), np.hypot(*delta.T)
    after = np.searchsorted(angles, bearing)
    low, high = (after - 1) % len(angles), after % len(angles)
    gap = np.maximum(np.abs(wrap_angle(angles[low] - bearing)), np.abs(wrap_angle(angles[high] - bearing)))
    nearer = np.minimum(ranges[low], ranges[high])
    faces = (inside.normals * delta).sum(axis=1) < 0.0
    in_sight = faces & (gap < _WIDEST_GAP) & (distance < nearer + _THROUGH)
    passed = in_sight & (distance < nearer - _THROUGH)
    return float(passed.sum()) / max(1, int(in_sight.sum()))
