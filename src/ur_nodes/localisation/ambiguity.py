"""Places of a map that fit the scans equally. Pure."""

from __future__ import annotations

import numpy as np

from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.localisation.particle_filter import Cluster, Particles, find_best_cluster

_LEAST_SHARE = 0.1  # of the weight of the best place: what another one must have
_MOST_PLACES = 4
_APART = (1.0, 0.6)  # m, rad: nearer particles belong to the same place


def find_places(particles: Particles) -> list[Cluster]:
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
