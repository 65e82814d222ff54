"""Subcell refinement of a scan's pose with a covariance that is correct in corridors, and walls that contradict it.

Sources: Chen and Medioni, Object modelling by registration of multiple range images, 1992 (the distance to the line);
Zhang, Kaess, Singh, On degeneracy of optimization-based state estimation problems, 2016 (directions that the scan says
nothing about are left to the prior).
"""

import math
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.correlative import Window, search
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats, Surface

_THROUGH = 0.3  # m: a beam that passes a wall by so much contradicts it
_WIDEST_GAP = 0.05  # rad: what lies between beams farther apart is not in sight


def contradiction(target: Surface, scan: MapScan, pose: Pose2, least: float = 0.0) -> float:
    """The share (0..1) of a map's points in sight of a scan at `pose` that its beams pass through.

    1 for a scan of fewer than two points, or where less than `least` (0..1) of the map is in sight; else 0 for nothing.
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
    if in_sight.sum() < least * len(delta):
        return 1.0
    return float(passed.sum()) / max(1, int(in_sight.sum()))


LEAST_NOISE: Floats = np.diag(np.square((0.002, 0.002, 0.0007)))
"""Errors (m, rad) that no covariance of a match contains."""


def rotate_covariance(covariance: Floats, yaw: float) -> Floats:
    """Express a covariance (3, 3), given in the parent frame of a pose with `yaw` (rad), in that of the pose."""
    c, s = math.cos(yaw), math.sin(yaw)
    rotation = np.array(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)))
    rotated: Floats = rotation @ covariance @ rotation.T
    return rotated


def position_deviation(covariance: Floats) -> float:
    """Return the standard deviation (m) of the position along its most uncertain direction."""
    return math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1]))


_REACHES = (0.5, 0.3, 0.2, 0.15)  # m: the farthest correspondences, falling with the iterations
_CLUMPED = 0.2  # how much a point without a line counts, in each direction
_TILT = 0.04  # rad: error of a normal; what it feigns to know along a wall is taken off
_LEVER = 3.0  # m: makes rad comparable with m
_LEAST_NOISE = 0.004  # m
_MOST_ITERATIONS = 12
_OUTLIER = 0.06  # m from a line, from which a point counts less and less
_DEPENDENT = 4.0  # neighbouring beams err alike: so many count as one
_HUGE = 10.0  # m or rad: no knowledge, against what moves between two scans
_DAMPING = np.diag((1e-3, 1e-3, 1e-3))  # 1/m2, 1/rad2: keeps the equations solvable without points and prior
_LONGEST_STEP = 0.3  # m, of one iteration
_CONVERGED = (2e-4, 1e-4)  # m, rad: a smaller step is the last one
_NOISE_AT_FIRST = 0.02  # m
_SIGMA_OF_MEDIAN = 1.48  # a normal distribution's standard deviation over its median absolute deviation
_LEAST_RESIDUALS = 10  # points whose residuals tell the noise


@dataclass(frozen=True, slots=True, eq=False)
class ScanMatch:
    """A pose, its covariance (3, 3) in the parent frame, and how good it is.

    `agreement` (0..1) is the share of the points that lie on the map; `noise` (m) their distance from its lines.
    The covariance holds no prior: along a corridor it is huge.
    """

    pose: Pose2
    covariance: Floats
    agreement: float
    noise: float


def match_surface(target: LocalMap, surface: Surface, guess: Pose2, prior: Floats | None = None) -> ScanMatch:
    """Find the pose near `guess` at which a surface lies on the map; `prior` is the covariance (3, 3) of the guess."""
    information = np.zeros((3, 3)) if prior is None else np.linalg.inv(prior)
    pose, start = np.array(guess, dtype=np.float64), np.array(guess, dtype=np.float64)
    known = np.zeros((3, 3))
    noise, agreement = _NOISE_AT_FIRST, 0.0
    for iteration in range(_MOST_ITERATIONS):
        reach = _REACHES[min(iteration, len(_REACHES) - 1)]
        hessian, gradient, noise, agreement = _normal_equations(target, surface, pose, reach, _OUTLIER, noise)
        known, share = _without_feigned(hessian)
        offset = pose - start
        offset[2] = wrap_angle(offset[2])
        scale = 1.0 / (noise * noise * _DEPENDENT)
        total = known * scale + information + _DAMPING
        step = np.linalg.solve(total, share @ gradient * scale + information @ offset)
        length = float(np.hypot(step[0], step[1]))
        if length > _LONGEST_STEP:
            step *= _LONGEST_STEP / length
        pose -= step
        if iteration >= len(_REACHES) and length < _CONVERGED[0] and abs(step[2]) < _CONVERGED[1]:
            break
    covariance = np.asarray(
        np.linalg.inv(known / (noise * noise * _DEPENDENT) + np.eye(3) / _HUGE**2), dtype=np.float64
    )
    return ScanMatch(
        Pose2(float(pose[0]), float(pose[1]), wrap_angle(float(pose[2]))), covariance, agreement, float(noise)
    )


def _normal_equations(
    target: LocalMap, surface: Surface, pose: Floats, reach: float, outlier: float, noise: float
) -> tuple[Floats, Floats, float, float]:
    """Gauss-Newton's matrix (3, 3) and gradient (3) for noise 1, the noise (m), and the share of points on the map."""
    moved = surface.moved(Pose2(pose[0], pose[1], pose[2]))
    numbers, found = target.nearest(moved.points, moved.normals, reach)
    if not found.any():
        return np.zeros((3, 3)), np.zeros(3), noise, 0.0
    numbers, points = numbers[found], moved.points[found]
    goal = target.surface.points[numbers]
    normals, flat = target.surface.normals[numbers], target.surface.flat[numbers]
    delta = points - goal
    lever = points - pose[:2]
    across = (delta * normals).sum(axis=1)
    along = delta[:, 1] * normals[:, 0] - delta[:, 0] * normals[:, 1]
    limit = max(outlier, 3.0 * noise)
    trust = np.square(1.0 / (1.0 + np.square(across / limit)))
    share = np.where(target.clumped[numbers], _CLUMPED**2, 0.0)
    clumped = share * np.square(1.0 / (1.0 + np.square(along / limit)))
    trust = np.where(flat, trust, share * trust)
    tangents = np.column_stack((-normals[:, 1], normals[:, 0]))
    hessian, gradient = np.zeros((3, 3)), np.zeros(3)
    for directions, residuals, weights in ((normals, across, trust), (tangents, along, clumped)):
        slopes = np.column_stack((directions, lever[:, 0] * directions[:, 1] - lever[:, 1] * directions[:, 0]))
        hessian += (slopes * weights[:, None]).T @ slopes
        gradient += slopes.T @ (weights * residuals)
    on_map = np.abs(across) < limit
    used = flat & on_map
    if used.sum() >= _LEAST_RESIDUALS:
        noise = max(_LEAST_NOISE, float(_SIGMA_OF_MEDIAN * np.median(np.abs(across[used]))))
    return hessian, gradient, noise, float(on_map.sum()) / len(surface)


def _without_feigned(hessian: Floats) -> tuple[Floats, Floats]:
    """Remove the false information that errors of normals cause; returns the rest (3, 3) and its share (3, 3)."""
    scale = np.array((1.0, 1.0, 1.0 / _LEVER))
    values, vectors = np.linalg.eigh(hessian * np.outer(scale, scale))
    values = np.maximum(values, 0.0)
    kept = np.maximum(values - _TILT**2 * values.sum(), 0.0)
    share = np.where(values > 0.0, kept / np.maximum(values, 1e-12), 0.0)
    rest = (vectors * kept) @ vectors.T / np.outer(scale, scale)
    return rest, (vectors * share) @ vectors.T * np.outer(1.0 / scale, scale)


POOR = 0.6
"""Agreement below which a match is doubted."""

_SLIPPED = 2.5  # standard deviations of the guess: by the scan, the wheels slip
_MOST_DOUBTED = 4.0  # likewise, of a match of poor agreement: among people, a scan fits a little everywhere
_SEARCHED = 3.0  # standard deviations of the guess that a search covers,
_LEAST_WINDOW = Window(0.2, 0.1)  # and at least this
_POINTS = 150  # of a scan, in a search
_LEAST_POINTS = 20  # of a scan that is searched for, and of the map
_LEAD = 0.05  # agreement by which a pose away from the guess must be better than one near it that agrees
_PRIOR_OF_SEARCH = 4.0  # times the covariance of the guess, which has failed


def locate_surface(
    local: LocalMap, surface: Surface, guess: Pose2, prior: Floats, before: Pose2, spread: Floats
) -> ScanMatch:
    """Match the surface of a scan to the map around the robot.

    `guess` is its pose by odometry, `prior` (3, 3) the covariance of that in the map's frame. Where the scan disagrees
    with it, the scan is also matched from `before`, the pose at the last scan, with the covariance `spread` (3, 3);
    where little agrees after that, it is searched for round the guess.
    """
    match = match_surface(local, surface, guess, prior)
    if _deviations(guess, match.pose, prior) > _SLIPPED or match.agreement < POOR:
        other = match_surface(local, surface, before, spread)
        lead = _LEAD if match.agreement >= POOR else 0.0  # along a corridor many places agree alike
        if _is_believed(other, guess, prior) and other.agreement > match.agreement + lead:
            match = other
    if match.agreement >= POOR or min(len(surface), len(local.surface)) < _LEAST_POINTS:
        return match
    shift, turn = _SEARCHED * math.sqrt(prior[0, 0] + prior[1, 1]), _SEARCHED * math.sqrt(prior[2, 2])
    window = Window(max(_LEAST_WINDOW.shift, shift), max(_LEAST_WINDOW.turn, turn))
    found = search(local.pyramid, surface.sample(_POINTS), guess, window)
    if found is None:
        return match
    other = match_surface(local, surface, found.pose, _PRIOR_OF_SEARCH * prior)
    return other if _is_believed(other, guess, prior) and other.agreement > match.agreement else match


def _is_believed(match: ScanMatch, guess: Pose2, prior: Floats) -> bool:
    """Return whether a match agrees well, or is near the guess: a scan fits partly in many places."""
    return match.agreement >= POOR or _deviations(guess, match.pose, prior) < _MOST_DOUBTED


def _deviations(guess: Pose2, found: Pose2, covariance: Floats) -> float:
    """The distance of a pose from a guess in standard deviations (Mahalanobis) of the guess, in the map's frame."""
    moved = np.array(guess.inverse().compose(found))
    return math.sqrt(float(moved @ np.linalg.solve(rotate_covariance(covariance, guess.yaw), moved)))
