"""geometry_msgs/PoseArray, written without an object for each pose."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
from geometry_msgs.msg import PoseArray
from numpy.typing import NDArray


class PosesMessage(PoseArray):
    """Many poses, written fast: `planar` is float64 (n, 3), m, m, rad; `poses` stays empty in what is sent."""

    __slots__ = ("planar",)
    planar: NDArray[np.float64]

    def serialize(self, buff: BinaryIO) -> None:
        """Write header, number and poses as http://wiki.ros.org/msg describes (little-endian)."""
        self.header.serialize(buff)
        buff.write(np.uint32(len(self.planar)).astype("<u4").tobytes())
        poses = np.zeros((len(self.planar), 7), dtype="<f8")
        poses[:, :2] = self.planar[:, :2]
        poses[:, 5] = np.sin(0.5 * self.planar[:, 2])
        poses[:, 6] = np.cos(0.5 * self.planar[:, 2])
        buff.write(poses.tobytes())
