"""A tree of frames, as far as a picture needs one: the latest transforms, no history, no interpolation."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.teleop.navigator.model import Place

Matrix = NDArray[np.float64]
"""(4, 4), homogeneous."""


class Link(NamedTuple):
    """A frame's pose in its parent: translation in m, rotation as a quaternion."""

    parent: str
    x: float
    y: float
    z: float
    qx: float
    qy: float
    qz: float
    qw: float


class FrameTree:
    """The newest link of each frame. Names may carry tf's old leading slash."""

    def __init__(self) -> None:
        self._links: dict[str, Link] = {}

    def update(self, child: str, link: Link) -> None:
        """Take a newer link."""
        self._links[child.lstrip("/")] = link

    def link(self, child: str) -> Link | None:
        """The newest link of a frame."""
        return self._links.get(child.lstrip("/"))

    def matrix(self, target: str, source: str) -> Matrix | None:
        """The transform of points of `source` into its ancestor `target`; None where they are not connected."""
        total = np.eye(4)
        frame, target = source.lstrip("/"), target.lstrip("/")
        for _ in range(len(self._links) + 1):
            if frame == target:
                return total
            link = self._links.get(frame)
            if link is None:
                return None
            total = _matrix_of(link) @ total
            frame = link.parent.lstrip("/")
        return None

    def place(self, target: str, source: str) -> Place | None:
        """The planar pose of `source` in its ancestor `target`."""
        matrix = self.matrix(target, source)
        if matrix is None:
            return None
        return Place(float(matrix[0, 3]), float(matrix[1, 3]), math.atan2(matrix[1, 0], matrix[0, 0]))


def scan_points(
    ranges: NDArray[np.float64], angle_min: float, angle_step: float, range_min: float, range_max: float
) -> NDArray[np.float64]:
    """The hits of a planar scan, (n, 3) in the scanner's frame; beams without a hit are left out."""
    angles = angle_min + angle_step * np.arange(len(ranges))
    good = np.isfinite(ranges) & (ranges >= range_min) & (ranges < range_max)
    r, a = ranges[good], angles[good]
    return np.stack((r * np.cos(a), r * np.sin(a), np.zeros_like(r)), axis=1)


def move_points(matrix: Matrix, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3) in the other frame."""
    moved: NDArray[np.float64] = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def _matrix_of(link: Link) -> Matrix:
    x, y, z, w = link.qx, link.qy, link.qz, link.qw
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if norm == 0.0:
        x, y, z, w, norm = 0.0, 0.0, 0.0, 1.0, 1.0
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), link.x],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), link.y],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), link.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
