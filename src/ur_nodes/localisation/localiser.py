"""Adaptive Monte Carlo localisation as a state machine without ROS: odometry and beams in, estimates out."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.localisation.likelihood import OCCUPIED_FROM, LikelihoodField, draw_free_poses, score_poses
from ur_nodes.localisation.motion_model import MotionModel, move_poses
from ur_nodes.localisation.particle_filter import (
    Cluster,
    Particles,
    SampleSize,
    draw_gaussian,
    effective_size,
    even_particles,
    find_best_cluster,
    keep_needed,
    resample,
    weigh,
)
from ur_nodes.localisation.scan_match import MatchSettings, RefinedPose, match_many, match_scan

LOST = 4.0
"""Doubt from which the robot counts as lost."""

_BEHIND = 0.3  # m: a beam that ends so far behind a wall has passed it
_MOST_SAMPLES = 400  # along a beam
LITTLE = 0.5
"""Agreement from which a scan is not doubted, even where its beams pass through walls."""

_CONTRADICTED = 0.15  # share of the beams that pass walls
_NEARLY_NONE, _SLOWLY = 0.15, 0.15  # agreement that is doubted, too, but slowly: a crowd may stand round the robot
_GOOD, _CLEAR = 0.6, 0.1


@dataclass(frozen=True, slots=True)
class PoseFit:
    """A scan at a pose on the map: shares (0..1) of its beams that end on walls, and that pass through walls."""

    agreement: float
    through: float

    @property
    def is_good(self) -> bool:
        """Return whether the scan fits this pose well."""
        return self.agreement >= _GOOD and self.through <= _CLEAR

    @property
    def is_contradicted(self) -> bool:
        """Return whether the scan sees through walls here, which no objects or people can cause."""
        return self.agreement < LITTLE and self.through > _CONTRADICTED


def step_doubt(doubt: float, fit: PoseFit) -> float:
    """Return the doubt after one more scan: it grows by at most 1, and is at least 0."""
    if fit.is_contradicted:
        return doubt + 1.0
    return doubt + _SLOWLY if fit.agreement < _NEARLY_NONE else max(0.0, doubt - 1.0)


def share_through_walls(grid: Grid, pose: Pose2, points: NDArray[np.float64]) -> float:
    """Return the share (0..1) of beams that end well behind a wall.

    `points` (n, 2) are their ends in the robot's frame, m.
    """
    lengths = np.hypot(*points.T)
    free = lengths - _BEHIND
    if not (free > 0.0).any():
        return 0.0
    step = max(grid.resolution, float(free.max()) / _MOST_SAMPLES)
    along = np.arange(step, float(free.max()) + step, step)
    beam, sample = np.nonzero(along < free[:, None])
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    directions = (points / np.maximum(lengths, 1e-9)[:, None]) @ np.array(((c, s), (-s, c)))
    places = pose[:2] + directions[beam] * along[sample, None]
    passed = np.zeros(len(points), bool)
    passed[beam[grid.values_at(places, outside=0) >= OCCUPIED_FROM]] = True
    return float(passed.mean())


# Global localisation: poses all over the map that fit one scan.
# Sensor resetting (Lenser and Veloso, 2000), with the places found by scoring many poses coarsely and matching the scan
# at the best of them.


POOL = 20000  # poses that are scored coarsely
MOST_POOL = 400000  # likewise in the first search of a large map
DENSITY = 40.0  # of them, on a square metre
BLOCK = 20000  # that are scored at a time, for the sake of memory
CANDIDATES = 300  # of which so many are matched to the scan, at least
SHARE = 0.005  # of the pool, likewise
REACH = 0.6  # m: a beam that ends farther from a wall is simply wrong
SPREAD = (0.04, 0.04, 0.02)  # m, m, rad: of the particles round a matched pose
COARSE = MatchSettings(outlier=0.4, iterations=5)
FINE = MatchSettings(outlier=0.1, iterations=4)


def propose_poses(
    field: LikelihoodField,
    points: NDArray[np.float64],
    count: int,
    beams: float,
    rng: np.random.Generator,
    size: int = POOL,
) -> NDArray[np.float64]:
    """Propose poses (count, 3) near places where beams would end at points (m, 2) in the robot's frame.

    Drawn by likelihood, as if `beams` of the beams were independent. The map must have a free cell. `size` poses are
    tried.
    """
    pool = draw_free_poses(field, size, rng)
    scores = np.concatenate([_score(field, pool[first : first + BLOCK], points) for first in range(0, size, BLOCK)])
    kept = max(CANDIDATES, round(SHARE * size))
    best = np.argpartition(scores, -kept)[-kept:]
    matched = match_many(field, match_many(field, pool[best], points, COARSE), points, FINE)
    matched = matched[field.grid.values_at(matched[:, :2]) == 0]
    if not len(matched):
        return pool[:count]
    fits = score_poses(field, matched, points)
    weights = np.exp(beams * (fits - fits.max()))
    drawn: NDArray[np.float64] = matched[rng.choice(len(matched), count, p=weights / weights.sum())]
    drawn += rng.standard_normal((count, 3)) * SPREAD
    drawn[:, 2] = wrap_angle(drawn[:, 2])
    return drawn


def pool_size(field: LikelihoodField) -> int:
    """Return the number of poses to try so that all of the map's free floor is covered; 20000 to 400000."""
    return int(min(MOST_POOL, max(POOL, DENSITY * field.free_count * field.grid.resolution**2)))


def _score(field: LikelihoodField, poses: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    return score_poses(field, poses, points, lambda distances: np.maximum(-np.abs(distances), -np.float32(REACH)))


_LEAST_SHARE = 0.1  # of the weight of the best place: what another one must have
_MOST_PLACES = 4
_APART = (1.0, 0.6)  # m, rad: nearer particles belong to the same place


def find_clusters(particles: Particles) -> list[Cluster]:
    """Find the clusters of particles with at least a tenth of the weight of the heaviest one, which is the first."""
    poses, weights = particles.poses, particles.weights
    found: list[Cluster] = []
    while len(found) < _MOST_PLACES and float(weights.sum()) > 0.0:
        left = float(weights.sum())
        best = find_best_cluster(Particles(poses, weights / left))
        found.append(Cluster(best.pose, best.covariance, best.share * left))
        far = np.hypot(*(poses[:, :2] - best.pose[:2]).T) > _APART[0]
        far |= np.abs(wrap_angle(poses[:, 2] - best.pose.yaw)) > _APART[1]
        poses, weights = poses[far], weights[far]
    found.sort(key=lambda place: -place.share)
    return [place for place in found if place.share >= _LEAST_SHARE * found[0].share]


INDEPENDENT_BEAMS = 20.0  # neighbouring beams err together: a scan is worth no more than so many
INDEPENDENT_STEP = 0.25  # m, rad: scans taken nearer to one another err together, too
SEARCH_UPDATES = 40  # after a request for global localisation: the duration of the search for poses that fit the scan
AMBIGUOUS = 4  # updates in a row in which more than one place fits
SEARCH_SHARE = 0.3  # of the particles come from there
LEAST_SHARE = 0.3  # of the particles must keep an effective weight in one update
LEAST_LOST = 0.1  # the averages differ as much when a person walks by
LEAST_BEAMS = 8  # fewer determine a pose too poorly
FOUND = 5  # updates in a row in which the scan fits in one place: a robot that was lost is there
_ALONG = 0.05  # m between two poses along a way without a place
_CLEARLY = 0.08  # mean log likelihood of a beam: 2 % of the beams meet a wall in place of nothing
_UNKNOWN = np.diag(np.square((0.3, 0.3, 0.15)))  # m, m, rad
_SLIP = np.diag(np.square((0.1, 0.1, 0.05)))  # m, m, rad: the cluster lags behind wheels that slip, as on a carpet
FARTHEST_MATCH = 0.4  # m, rad: a refined pose farther from its cluster has slipped to other walls


@dataclass(frozen=True, slots=True)
class FilterSettings:
    """Parameters of the filter. Distances in m, angles in rad; names are those of amcl's parameters.

    `recovery_alpha_slow` and `_fast` are the rates of the averages whose ratio determines the number of random
    particles to add; 0 adds none. `refine` matches the scan to the map from the best cluster's pose. `notice_lost`:
    search the whole map when scans no longer fit.
    """

    size: SampleSize
    motion: MotionModel
    max_beams: int = 30
    update_min_d: float = 0.2
    update_min_a: float = math.pi / 6.0
    resample_interval: int = 2
    recovery_alpha_slow: float = 0.0
    recovery_alpha_fast: float = 0.0
    selective_resampling: bool = False
    refine: bool = True
    notice_lost: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class ClusterEstimate:
    """An estimate: pose in the map, covariance (3, 3) of its cluster, the cluster's share of all weight.

    `agreement` is the share (0..1) of the beams on walls there; 0 where none were matched.
    """

    pose: Pose2
    covariance: NDArray[np.float64]
    share: float
    agreement: float = 0.0


class ParticleLocaliser:
    """A particle filter on one map. Deterministic for the same generator, `settings`, calls and arguments."""

    def __init__(self, field: LikelihoodField, settings: FilterSettings, rng: np.random.Generator) -> None:
        self.settings = settings
        self._field = field
        self._rng = rng
        self._match = MatchSettings()
        self._particles = even_particles(np.zeros((1, 3)))
        self._odometry: Pose2 | None = None  # at the last update; None: the next scan updates in any case
        self._forced = False
        self._updates = 0
        self._search = 0  # updates left in which to seek places that fit the scan
        self._slow = self._fast = 0.0  # averages of how well scans fit
        self._places: list[Pose2] = []  # after the last update, during a search
        self._ambiguous = 0  # updates in a row with more than one
        self._doubt = 0.0
        self._found = 0  # updates in a row in which a lost robot seems to be found
        self._lost = False

    @property
    def lost(self) -> bool:
        """Return whether the robot is lost; the map is then searched until one place fits."""
        return self._lost

    @property
    def poses(self) -> list[Pose2]:
        """The places, at least two, that fit equally during a global localisation, the best first; else none.

        The search continues while there are any.
        """
        return self._places if self._ambiguous >= AMBIGUOUS else []

    @property
    def particles(self) -> Particles:
        """The particles after the last update; read only."""
        return self._particles

    def set_pose(self, pose: Pose2, covariance: NDArray[np.float64]) -> None:
        """Restart around a pose, with a covariance (3, 3)."""
        self._restart(draw_gaussian(pose, covariance, self.settings.size.maximum, self._rng))
        self._lost = False

    def scatter(self) -> bool:
        """Restart with particles on all free cells, for a global localisation. False if the map has none."""
        if not self._field.free_count:
            return False
        self._restart(draw_free_poses(self._field, self.settings.size.maximum, self._rng))
        self._search = SEARCH_UPDATES
        return True

    def request_update(self) -> None:
        """Use the next scan even when the robot has not moved."""
        self._forced = True

    def match_alone(self, pose: Pose2, points: NDArray[np.float64]) -> RefinedPose:
        """Match a scan near a pose, as if next to nothing was known of that: odometry has no influence."""
        if len(points) < LEAST_BEAMS:
            return RefinedPose(pose, np.linalg.inv(_UNKNOWN), 0.0)
        return match_scan(self._field, pose, _UNKNOWN, points, self._match)

    def find_along(
        self, pose: Pose2, axis: NDArray[np.float64], reach: float, points: NDArray[np.float64]
    ) -> Pose2 | None:
        """Return the pose at most `reach` (m) away along an axis (2) that a scan fits clearly better; None for none."""
        if not reach or len(points) < LEAST_BEAMS:
            return None
        steps = np.arange(-reach, reach + _ALONG, _ALONG)
        steps = np.concatenate(((0.0,), steps))
        poses = np.array(pose) + np.outer(steps, (*axis, 0.0))
        scores = score_poses(self._field, poses, points)
        best = int(np.argmax(scores))
        return Pose2(*map(float, poses[best])) if scores[best] - scores[0] > _CLEARLY else None

    def update(self, odometry: Pose2, points: NDArray[np.float64]) -> ClusterEstimate | None:
        """Update with a scan: the ends (m, 2) of its beams in the robot's frame, and the odometry's pose at its stamp.

        Returns None, and changes nothing, when the robot has moved less than update_min_d and turned less than
        update_min_a since the last update.
        """
        if not self._is_due(odometry):
            return None
        settings = self.settings
        particles = self._moved(odometry)
        novelty = self._novelty(odometry)
        count = len(points)
        chosen = points[np.linspace(0, count - 1, min(count, settings.max_beams)).round().astype(np.intp)]
        if len(chosen) >= LEAST_BEAMS:
            beams = min(INDEPENDENT_BEAMS, float(len(chosen))) * novelty
            if self._search == SEARCH_UPDATES:
                particles = even_particles(self._propose(chosen, len(particles), pool_size(self._field)))
            scores = score_poses(self._field, particles.poses, chosen)
            self._average(float(particles.weights @ np.exp(scores)))
            particles, _ = weigh(particles, scores, beams, LEAST_SHARE)
        cluster = find_best_cluster(particles)
        estimate = self._refined(cluster, points)
        self._particles = self._resampled(particles, chosen)
        self._odometry = odometry
        self._forced = False
        self._updates += 1
        if self._search:
            self._places = [place.pose for place in find_clusters(particles)]
            self._ambiguous = self._ambiguous + 1 if len(self._places) > 1 else 0
            self._search = max(1 if self._ambiguous else 0, self._search - 1)
        if settings.notice_lost and len(chosen) >= LEAST_BEAMS:
            self._judge(estimate, chosen)
        return estimate

    def _judge(self, estimate: ClusterEstimate, points: NDArray[np.float64]) -> None:
        """Determine whether the robot is lost, and search if it is."""
        agreement = estimate.agreement
        if self._lost or agreement < _GOOD:
            agreement = match_scan(self._field, estimate.pose, estimate.covariance, points, self._match).agreement
        decisive = self._lost or agreement < LITTLE  # else walls decide nothing, and tracing them takes long
        through = share_through_walls(self._field.grid, estimate.pose, points) if decisive else 0.0
        fit = PoseFit(agreement, through)
        self._doubt = step_doubt(self._doubt, fit)
        if self._lost:
            self._found = self._found + 1 if fit.is_good and not self._ambiguous else 0
            self._lost = self._found < FOUND
            if self._lost and not self._search:
                self.scatter()
        elif self._doubt >= LOST:
            self._lost = self.scatter()
        self._forced = self._lost or fit.is_contradicted  # it may stand still

    def _restart(self, poses: NDArray[np.float64]) -> None:
        self._particles = even_particles(keep_needed(poses, self.settings.size))
        self._odometry = None
        self._updates = self._search = self._ambiguous = self._found = 0
        self._doubt = 0.0
        self._slow = self._fast = 0.0

    def _is_due(self, odometry: Pose2) -> bool:
        last = self._odometry
        if last is None or self._forced:
            return True
        moved = math.hypot(odometry.x - last.x, odometry.y - last.y)
        turned = abs(wrap_angle(odometry.yaw - last.yaw))
        return moved >= self.settings.update_min_d or turned >= self.settings.update_min_a

    def _moved(self, odometry: Pose2) -> Particles:
        old = self._particles
        if self._odometry is None:
            return old
        poses = move_poses(old.poses, self._odometry, odometry, self.settings.motion, self._rng)
        return Particles(poses, old.weights)

    def _average(self, likelihood: float) -> None:
        settings = self.settings
        if not self._slow:
            self._slow = self._fast = likelihood
        self._slow += settings.recovery_alpha_slow * (likelihood - self._slow)
        self._fast += settings.recovery_alpha_fast * (likelihood - self._fast)

    def _refined(self, cluster: Cluster, points: NDArray[np.float64]) -> ClusterEstimate:
        raw = ClusterEstimate(cluster.pose, cluster.covariance, cluster.share)
        if not self.settings.refine or len(points) < LEAST_BEAMS:
            return raw
        match = match_scan(self._field, cluster.pose, cluster.covariance + _SLIP, points, self._match)
        far = math.hypot(match.pose.x - cluster.pose.x, match.pose.y - cluster.pose.y)
        turned = abs(wrap_angle(match.pose.yaw - cluster.pose.yaw))
        if far > FARTHEST_MATCH or turned > FARTHEST_MATCH:
            return raw
        return ClusterEstimate(match.pose, cluster.covariance, cluster.share, match.agreement)

    def _novelty(self, odometry: Pose2) -> float:
        """Return the weight of a scan at this pose after the last one, 0.1 to 1."""
        last = self._odometry
        if last is None:
            return 1.0
        moved = math.hypot(odometry.x - last.x, odometry.y - last.y) + abs(wrap_angle(odometry.yaw - last.yaw))
        return min(1.0, max(0.1, moved / INDEPENDENT_STEP))

    def _resampled(self, particles: Particles, points: NDArray[np.float64]) -> Particles:
        settings = self.settings
        if self._updates % settings.resample_interval:
            return particles
        if settings.selective_resampling and effective_size(particles.weights) > 0.5 * len(particles):
            return particles
        share = 0.0
        size = pool_size(self._field) if self._search and len(self._places) > 1 else POOL
        if self._field.free_count and len(points) >= LEAST_BEAMS:
            lost = 1.0 - self._fast / self._slow if self._slow else 0.0
            share = max(lost - LEAST_LOST, SEARCH_SHARE if self._search else 0.0)
        return resample(particles, settings.size, self._rng, share, lambda count: self._propose(points, count, size))

    def _propose(self, points: NDArray[np.float64], count: int, size: int = POOL) -> NDArray[np.float64]:
        return propose_poses(self._field, points, count, INDEPENDENT_BEAMS, self._rng, size)
