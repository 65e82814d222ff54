"""Particles: weighted poses, and the steps of a particle filter. Pure: random numbers come from a given generator.

Sources: Fox, "Adapting the sample size in particle filters through KLD-sampling" (2003); Thrun, Burgard, Fox,
Probabilistic Robotics, sections 4.3 and 8.3.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle

BIN_METRES = 0.5
BIN_RADIANS = math.radians(10.0)

DrawPoses = Callable[[int], NDArray[np.float64]]

_RADIUS, _ANGLE = 0.6, 0.6  # m, rad: of a cluster


@dataclass(frozen=True, slots=True, eq=False)
class Particles:
    """`poses` float64 (n, 3): m, m, rad; `weights` float64 (n), which add up to 1."""

    poses: NDArray[np.float64]
    weights: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.poses)


@dataclass(frozen=True, slots=True)
class SampleSize:
    """The number of particles: between two limits, enough for an error of `kld_err` with the quantile `kld_z`."""

    minimum: int
    maximum: int
    kld_err: float
    kld_z: float


@dataclass(frozen=True, slots=True, eq=False)
class Cluster:
    """The best cluster of particles: mean pose, covariance (3, 3) in m and rad, and its share of the weight."""

    pose: Pose2
    covariance: NDArray[np.float64]
    share: float


def even_particles(poses: NDArray[np.float64]) -> Particles:
    """Return particles of equal weight."""
    return Particles(poses, np.full(len(poses), 1.0 / len(poses)))


def draw_gaussian(
    mean: Pose2, covariance: NDArray[np.float64], count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw poses (count, 3) around a mean; `covariance` (3, 3) may be singular."""
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    offsets: NDArray[np.float64] = rng.standard_normal((count, 3)) * np.sqrt(np.maximum(values, 0.0)) @ vectors.T
    offsets += np.array(mean)
    offsets[:, 2] = wrap_angle(offsets[:, 2])
    return offsets


def effective_size(weights: NDArray[np.float64]) -> float:
    """The effective number of particles: 1 / sum of squared weights."""
    return float(1.0 / np.dot(weights, weights))


def weigh(
    particles: Particles, scores: NDArray[np.float64], beams: float, least_share: float
) -> tuple[Particles, float]:
    """Return the particles with weights multiplied by exp(exponent * scores), and the exponent.

    `scores` (n) are mean log likelihoods per beam. The exponent is `beams`, the number of beams that count as
    independent, or less where that would leave an effective size below `least_share` of the particles (or of what the
    old weights were worth): a sharp scan then convinces over several updates instead of killing all but the luckiest
    particle of a thin sample.
    """
    best = scores.max()
    wanted = min(least_share * len(particles), 0.9 * effective_size(particles.weights))

    def weights_at(exponent: float) -> NDArray[np.float64]:
        weights: NDArray[np.float64] = particles.weights * np.exp(exponent * (scores - best))
        weights /= weights.sum()
        return weights

    weights = weights_at(beams)
    if effective_size(weights) >= wanted:
        return Particles(particles.poses, weights), beams
    low, high = 0.0, beams
    for _ in range(12):
        middle = 0.5 * (low + high)
        if effective_size(weights_at(middle)) >= wanted:
            low = middle
        else:
            high = middle
    return Particles(particles.poses, weights_at(low)), low


def kld_limit(bins: NDArray[np.integer] | int, size: SampleSize) -> NDArray[np.float64]:
    """Return the number of particles for a distribution that fills so many bins (formula 7 of Fox), limited."""
    k = np.maximum(np.asarray(bins, dtype=np.float64), 2.0) - 1.0
    a = 2.0 / (9.0 * k)
    needed = k / (2.0 * size.kld_err) * (1.0 - a + np.sqrt(a) * size.kld_z) ** 3
    limited: NDArray[np.float64] = np.clip(np.ceil(needed), size.minimum, size.maximum)
    return limited


def resample(
    particles: Particles,
    size: SampleSize,
    rng: np.random.Generator,
    fresh_share: float = 0.0,
    draw_fresh: DrawPoses | None = None,
) -> Particles:
    """Draw as many particles as the distribution needs, by weight, all with equal weight.

    About `fresh_share` (0..1) of them come from `draw_fresh(count)` instead, which gives poses (count, 3).
    """
    count = min(size.maximum, max(4 * size.minimum, 2 * len(particles)))
    while True:
        drawn = _draw(particles, count, rng)
        if draw_fresh and fresh_share > 0.0:
            replaced = np.flatnonzero(rng.random(count) < fresh_share)
            drawn[replaced] = draw_fresh(len(replaced))
        kept = keep_needed(drawn, size)
        if len(kept) < count or count >= size.maximum:
            return even_particles(kept)
        count = min(size.maximum, 2 * count)


def keep_needed(poses: NDArray[np.float64], size: SampleSize) -> NDArray[np.float64]:
    """Return the first of these poses (n, 3), as many as their number of bins requires; at most all."""
    _, first = np.unique(bins_of_poses(poses, BIN_METRES, BIN_RADIANS), return_index=True)
    new = np.zeros(len(poses), dtype=np.intp)
    new[first] = 1
    enough = np.flatnonzero(np.arange(1, len(poses) + 1) >= kld_limit(np.cumsum(new), size))
    return poses[: int(enough[0]) + 1] if len(enough) else poses


def _draw(particles: Particles, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Systematic resampling, in random order so that any first part of it is a fair sample."""
    places = (np.arange(count) + rng.random()) / count
    chosen = np.searchsorted(np.cumsum(particles.weights), places).clip(0, len(particles) - 1)
    rng.shuffle(chosen)
    drawn: NDArray[np.float64] = particles.poses[chosen]
    return drawn


def bins_of_poses(poses: NDArray[np.float64], metres: float, radians: float) -> NDArray[np.int64]:
    """Return a number (n) per pose, equal for poses in the same cell of the grid of positions and headings."""
    cells = np.floor(poses / (metres, metres, radians)).astype(np.int64)
    numbers: NDArray[np.int64] = ((cells[:, 0] + 2**20 << 21) + cells[:, 1] + 2**20 << 10) + cells[:, 2] + 2**9
    return numbers


def find_best_cluster(particles: Particles) -> Cluster:
    """Find the cluster of particles with the most weight: all within _RADIUS and _ANGLE of its mean."""
    poses, weights = particles.poses, particles.weights
    _, member = np.unique(bins_of_poses(poses, _RADIUS, _ANGLE), return_inverse=True)
    heaviest = int(np.argmax(np.bincount(member, weights)))
    inside = member == heaviest
    for _ in range(3):
        mean = _mean(poses[inside], weights[inside])
        near = (np.square(poses[:, :2] - mean[:2]).sum(axis=1) <= _RADIUS * _RADIUS) & (
            np.abs(wrap_angle(poses[:, 2] - mean[2])) <= _ANGLE
        )
        if not near.any() or np.array_equal(near, inside):
            break
        inside = near
    chosen, share = poses[inside], weights[inside]
    mean = _mean(chosen, share)
    offsets = chosen - mean
    offsets[:, 2] = wrap_angle(offsets[:, 2])
    total = float(share.sum())
    covariance = (offsets * (share / total)[:, None]).T @ offsets
    return Cluster(Pose2(*(float(value) for value in mean)), covariance, total)


def _mean(poses: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y = weights @ poses[:, :2] / weights.sum()
    yaw = math.atan2(weights @ np.sin(poses[:, 2]), weights @ np.cos(poses[:, 2]))
    return np.array((x, y, yaw))
