"""The outline of a robot: radii, and the points of it that must not touch anything."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2


@dataclass(frozen=True, slots=True, eq=False)
class Footprint:
    """The robot's outline on the ground.

    `outline` (n, 2) are its corners in the base frame in m, n >= 3. `inscribed` is the radius of the greatest circle
    about the base's origin that the robot covers, `circumscribed` that of the smallest that covers it. `samples`
    (m, 2) are points of it, no two neighbours further apart than the resolution they were made for.
    """

    outline: NDArray[np.float64]
    inscribed: float
    circumscribed: float
    samples: NDArray[np.float64]

    def outline_at(self, pose: Pose2) -> NDArray[np.float64]:
        """The outline (n, 2) of a robot at a pose."""
        return pose.transform_points(self.outline)


def footprint_of_outline(points: tuple[tuple[float, float], ...], resolution: float, padding: float = 0.0) -> Footprint:
    """A footprint from its corners in order; `padding` (m) moves each corner out along both axes, as move_base does.

    Raises ValueError when there are fewer than three corners or the origin is outside.
    """
    outline = np.array(points, dtype=np.float64).reshape(-1, 2)
    if len(outline) < 3:
        raise ValueError("fewer than three corners")
    outline = outline + np.sign(outline) * padding
    if not _inside(outline, np.zeros((1, 2)))[0]:
        raise ValueError("the base's origin is outside the outline")
    nexts = np.roll(outline, -1, axis=0)
    edges = nexts - outline
    along = np.clip(-(outline * edges).sum(1) / np.maximum((edges**2).sum(1), 1e-12), 0.0, 1.0)
    inscribed = float(np.hypot(*(outline + along[:, None] * edges).T).min())
    circumscribed = float(np.hypot(*outline.T).max())
    return Footprint(outline, inscribed, circumscribed, _sample(outline, nexts, resolution))


def footprint_of_radius(radius: float, resolution: float, padding: float = 0.0) -> Footprint:
    """A round footprint, as 16 corners on the circle (move_base does the same)."""
    angles = np.arange(16) * (math.pi / 8.0)
    points = tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles)
    return footprint_of_outline(points, resolution, padding)


def _sample(outline: NDArray[np.float64], nexts: NDArray[np.float64], resolution: float) -> NDArray[np.float64]:
    edge_points = []
    for start, end in zip(outline, nexts, strict=True):
        count = max(1, math.ceil(float(np.hypot(*(end - start))) / resolution))
        edge_points.append(start + (end - start) * (np.arange(count) / count)[:, None])
    low, high = outline.min(axis=0), outline.max(axis=0)
    xs = np.arange(low[0] + resolution / 2, high[0], resolution)
    ys = np.arange(low[1] + resolution / 2, high[1], resolution)
    grid = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    return np.concatenate((*edge_points, grid[_inside(outline, grid)]))


def _inside(outline: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Even-odd rule, points (n, 2)."""
    x, y = points[:, 0, None], points[:, 1, None]
    x1, y1 = outline.T
    x2, y2 = np.roll(outline, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        crosses = ((y1 > y) != (y2 > y)) & (x < (x2 - x1) * (y - y1) / (y2 - y1) + x1)
    inside: NDArray[np.bool_] = crosses.sum(axis=1) % 2 == 1
    return inside
