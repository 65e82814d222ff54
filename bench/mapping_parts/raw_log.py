"""Logs with the robot's own odometry, NAME.npz, and the pairs of scans between which errors count, NAME.relations."""

from pathlib import Path

import numpy as np
from bench.mapping_parts.log import Floats, Log
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2


def read_raw_log(path: Path) -> Log:
    """Read a log: arrays `t`, `ranges`, `angles` (first, step), `laser` (mount), `odom` and `truth`.

    A relation is a line: the stamps of its two scans, the pose of the second in the first, and 1 where it is a loop.
    """
    with np.load(path) as arrays:
        ranges = arrays["ranges"].astype(np.float32)
        least, most = (float(limit) for limit in arrays["limits"])
        ranges[ranges >= most] = np.inf
        first, step = arrays["angles"]
        stamps = arrays["t"]
        return Log(
            name=path.stem,
            stamps=stamps,
            ranges=ranges,
            angles=first + step * np.arange(ranges.shape[1]),
            mount=Pose2(*arrays["laser"]),
            range_limits=(least, most),
            odometry=arrays["odom"],
            reference=arrays["truth"],
            loops=_read_loops(path.with_suffix(".relations"), stamps),
        )


def _read_loops(path: Path, stamps: Floats) -> NDArray[np.intp]:
    relations = np.loadtxt(path, usecols=(0, 1, 5), ndmin=2)
    loops: NDArray[np.intp] = np.abs(relations[relations[:, 2] == 1.0, :2, None] - stamps).argmin(axis=2)
    return loops
