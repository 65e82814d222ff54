"""Many poses as one geometry_msgs/PoseArray, fast: one numpy array instead of an object per number."""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import PoseArray
from numpy.typing import NDArray


class CloudMessage(PoseArray):  # type: ignore[misc]  # generated message classes have no types
    """A PoseArray to publish, not to read: `planar` is float64 (n, 3), m, m, rad; `poses` stays empty."""

    __slots__ = ("planar",)

    def __init__(self, frame: str, stamp: Any, planar: NDArray[np.float64]) -> None:
        super().__init__()
        self.header.frame_id = frame
        self.header.stamp = stamp
        self.planar = planar

    def serialize(self, buff: Any) -> None:
        """Write header, number and poses as http://wiki.ros.org/msg describes (little-endian)."""
        self.header.serialize(buff)
        buff.write(np.uint32(len(self.planar)).astype("<u4").tobytes())
        poses = np.zeros((len(self.planar), 7), dtype="<f8")
        poses[:, :2] = self.planar[:, :2]
        poses[:, 5] = np.sin(0.5 * self.planar[:, 2])
        poses[:, 6] = np.cos(0.5 * self.planar[:, 2])
        buff.write(poses.tobytes())
