import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.particle_filter import (
    Particles,
    SampleSize,
    draw_gaussian,
    effective_size,
    even_particles,
    find_best_cluster,
    keep_needed,
    kld_limit,
    resample,
    weigh,
)

SIZE = SampleSize(minimum=50, maximum=5000, kld_err=0.05, kld_z=2.33)


def cloud(mean: Pose2, spread: float, count: int, seed: int = 0) -> np.ndarray:
    return draw_gaussian(mean, np.diag((spread**2, spread**2, spread**2)), count, np.random.default_rng(seed))


def test_kld_limit_agrees_with_the_chi_square_quantile() -> None:
    from scipy.stats import chi2

    # Formula 7 approximates chi2(k - 1) at 1 - delta over 2 epsilon; 2.33 is the normal quantile of 0.99.
    for bins in (5, 20, 100):
        exact = chi2.ppf(0.99, bins - 1) / (2.0 * SIZE.kld_err)
        assert float(kld_limit(bins, SIZE)) == pytest.approx(max(exact, SIZE.minimum), rel=0.02)


def test_keep_needed_shrinks_with_the_spread() -> None:
    wide, narrow = (len(keep_needed(cloud(Pose2(0.0, 0.0, 0.0), spread, 5000), SIZE)) for spread in (1.5, 0.02))
    assert wide > 10 * narrow
    assert SIZE.minimum <= narrow <= 200


def test_resample_draws_by_weight() -> None:
    poses = np.array(((0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (9.0, 9.0, 0.0)))
    drawn = resample(Particles(poses, np.array((0.75, 0.25, 0.0))), SIZE, np.random.default_rng(0))
    assert (drawn.poses[:, 0] == 0.0).mean() == pytest.approx(0.75, abs=0.08)
    assert (drawn.poses[:, 1] == 0.0).all()
    assert drawn.weights.sum() == pytest.approx(1.0)


def test_resample_mixes_in_fresh_poses() -> None:
    drawn = resample(
        even_particles(np.zeros((500, 3))), SIZE, np.random.default_rng(0), 0.3, lambda count: np.full((count, 3), 2.0)
    )
    assert (drawn.poses[:, 0] == 2.0).mean() == pytest.approx(0.3, abs=0.1)


def test_weigh_multiplies_by_likelihood_when_particles_remain() -> None:
    scores = np.array((0.0, -0.01, -0.02, 0.0))
    weighed, exponent = weigh(even_particles(np.zeros((4, 3))), scores, 20.0, 0.3)
    expected = np.exp(20.0 * scores)
    assert exponent == 20.0
    assert weighed.weights == pytest.approx(expected / expected.sum())


def test_weigh_spares_particles_from_a_sharp_scan() -> None:
    scores = -np.linspace(0.0, 50.0, 1000)
    weighed, exponent = weigh(even_particles(np.zeros((1000, 3))), scores, 20.0, 0.3)
    assert 0.0 < exponent < 20.0
    assert effective_size(weighed.weights) >= 300.0
    assert weighed.weights.argmax() == 0


def test_find_best_cluster_takes_the_heavier_of_two_heaps() -> None:
    poses = np.vstack((cloud(Pose2(0.0, 0.0, 0.0), 0.05, 300), cloud(Pose2(5.0, 5.0, 1.0), 0.05, 100, 1)))
    weights = np.concatenate((np.full(300, 1.0), np.full(100, 9.0)))
    best = find_best_cluster(Particles(poses, weights / weights.sum()))
    assert best.pose == pytest.approx((5.0, 5.0, 1.0), abs=0.02)
    assert best.share == pytest.approx(0.75)
    assert np.sqrt(np.diag(best.covariance)) == pytest.approx((0.05, 0.05, 0.05), rel=0.25)


def test_find_best_cluster_averages_headings_round_the_half_turn() -> None:
    best = find_best_cluster(even_particles(cloud(Pose2(1.0, 1.0, math.pi), 0.1, 400)))
    assert abs(abs(best.pose.yaw) - math.pi) < 0.03
    assert best.covariance[2, 2] == pytest.approx(0.01, rel=0.3)
