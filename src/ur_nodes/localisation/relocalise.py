"""Global localisation: poses all over the map that fit one scan.

Sensor resetting (Lenser and Veloso, 2000), with the places found by scoring many poses coarsely and matching the scan
at the best of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.localisation.likelihood import LikelihoodField, draw_free_poses, score_poses
from ur_nodes.localisation.scan_match import MatchSettings, match_many

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
