"""Refine a pose until the ends of the beams lie on the walls of the map: Gauss-Newton on the distance field."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.localisation.likelihood import LikelihoodField


@dataclass(frozen=True, slots=True)
class MatchSettings:
    """`sigma` (m): spread of a beam's end about the wall, larger than the lidar's noise because neighbours err alike.

    Ends farther than about `outlier` (m) from any wall get lower weights: they hit objects that the map does not have.
    """

    sigma: float = 0.05
    outlier: float = 0.1
    iterations: int = 6


@dataclass(frozen=True, slots=True, eq=False)
class RefinedPose:
    """A refined pose, the inverse (3, 3) of its covariance, and the share (0..1) of the beams on walls there."""

    pose: Pose2
    information: NDArray[np.floating]
    agreement: float

    @property
    def covariance(self) -> NDArray[np.floating]:
        """Return the covariance (3, 3) of the pose."""
        return np.linalg.inv(self.information)


_LEAST = np.diag((1e-8, 1e-8, 1e-8))  # m^2, m^2, rad^2


def match_scan(
    field: LikelihoodField,
    prior: Pose2,
    covariance: NDArray[np.float64],
    points: NDArray[np.float64],
    settings: MatchSettings,
) -> RefinedPose:
    """Find the most likely pose for a Gaussian prior and beams that end at points (m, 2) in the robot's frame.

    Residuals are signed distances to walls, read with bilinear interpolation; weights are Geman-McClure's, and none for
    ends on the far side of a wall. Along directions that the scan does not determine (a corridor) the prior decides.
    """
    information = np.linalg.inv(covariance + _LEAST)
    pose = np.array(prior, dtype=np.float64)
    hessian, agreement = information, 0.0
    for _ in range(settings.iterations):
        offset = pose - np.asarray(prior)
        offset[2] = wrap_angle(offset[2])
        normal, gradient, share = _normal_equations(field, pose[None], points, settings)
        hessian, agreement = information + normal[0], float(share[0])
        step = np.linalg.solve(hessian, information @ offset + gradient[0])
        pose -= step
        if abs(step[0]) + abs(step[1]) < 5e-4 and abs(step[2]) < 5e-4:
            break
    return RefinedPose(Pose2(float(pose[0]), float(pose[1]), wrap_angle(float(pose[2]))), hessian, agreement)


def match_many(
    field: LikelihoodField, poses: NDArray[np.float64], points: NDArray[np.float64], settings: MatchSettings
) -> NDArray[np.float64]:
    """Move poses (n, 3) each to the nearest place where the scan fits; steps are damped as there is no prior."""
    damping = len(points) / settings.sigma**2 * np.diag((1e-2, 1e-2, 1e-2))
    moved: NDArray[np.float64] = poses.copy()
    for _ in range(settings.iterations):
        normal, gradient, _ = _normal_equations(field, moved, points, settings)
        moved -= np.linalg.solve(normal + damping, gradient[..., None])[..., 0]
    moved[:, 2] = wrap_angle(moved[:, 2])
    return moved


def _normal_equations(
    field: LikelihoodField, poses: NDArray[np.float64], points: NDArray[np.float64], settings: MatchSettings
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return for poses (n, 3) Gauss-Newton's matrix (n, 3, 3), gradient (n, 3), and the share (n) of beams on walls."""
    residuals, slopes, on_near_side = _linearise(field, poses, points)
    trust = np.square(1.0 / (1.0 + np.square(residuals / settings.outlier)))
    trust *= on_near_side
    weighted = slopes * (trust / (settings.sigma * settings.sigma))[:, None, :]
    share = trust.sum(axis=1) / trust.shape[1]
    return weighted @ slopes.transpose(0, 2, 1), (weighted @ residuals[..., None])[..., 0], share


def _linearise(
    field: LikelihoodField, poses: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return signed distances (n, m) of the beams' ends to walls, and their derivatives (n, 3, m) by x, y and yaw.

    The third selects the ends (n, m) on the near side of a wall: further along the beam lies the wall. An end on the
    far half of a thin wall would be drawn to the back of it, which no beam can see.
    """
    grid = field.grid
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    x, y = points.T
    turned_x, turned_y = c * x - s * y, s * x + c * y
    rows, columns = grid.fractions_at(turned_x + poses[:, 0, None], turned_y + poses[:, 1, None])
    # 0.5: the border, less half a cell to its centre.
    values, down, right = _interpolate(field, rows + 0.5, columns + 0.5)
    down, right = down / grid.resolution, right / grid.resolution
    if grid.origin.yaw:
        co, so = math.cos(grid.origin.yaw), math.sin(grid.origin.yaw)
        down, right = so * right + co * down, co * right - so * down
    slopes = np.empty((len(values), 3, values.shape[1]))
    slopes[:, 0], slopes[:, 1], slopes[:, 2] = right, down, down * turned_x - right * turned_y
    return values, slopes, right * turned_x + down * turned_y < 0.0


def _interpolate(
    field: LikelihoodField, rows: NDArray[np.float64], columns: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Interpolate distances (...) at rows and columns (...) between cells' centres, and their slopes down and right."""
    height, width = field.distances.shape
    row = np.minimum(np.maximum(rows, 0.0), height - 1.001)  # np.clip takes three times as long
    column = np.minimum(np.maximum(columns, 0.0), width - 1.001)
    top, left = row.astype(np.intp), column.astype(np.intp)
    fr, fc = row - top, column - left
    if not field.complete:
        field.cover(np.stack((top, top + 1)), np.stack((left, left + 1)))
    index = top * width + left
    flat = field.distances.ravel()
    a, b = flat.take(index).astype(np.float64), flat.take(index + 1)
    d, e = flat.take(index + width), flat.take(index + width + 1)
    upper, lower = a + fc * (b - a), d + fc * (e - d)
    return upper + fr * (lower - upper), lower - upper, (1.0 - fr) * (b - a) + fr * (e - d)
