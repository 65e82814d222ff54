"""Covariances (3, 3) of planar poses: x and y in m, yaw in rad."""

import math

import numpy as np

from ur_nodes.slam.matching.surface import Floats

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
