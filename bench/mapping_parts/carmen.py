"""Public lidar logs in CARMEN's format. Their poses are corrected ones: a reference, not the truth."""

import gzip
import math
from pathlib import Path

import numpy as np
from bench.mapping_parts.log import Log, with_odometry_noise

from ur_nodes.geometry.pose import Pose2

_FARTHEST = 20.0  # m: what the lidars of these logs can be trusted to


def read_carmen(path: Path, seed: int) -> Log:
    """Read the FLASER lines of a log, plain or gzip; odometry noise is added as the logs hold corrected odometry."""
    ranges, odometry, reference, stamps = [], [], [], []
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as lines:
        for line in lines:
            if not line.startswith("FLASER "):
                continue
            words = line.split()
            count = int(words[1])
            values = np.array(words[2 : 2 + count + 7], dtype=np.float64)
            ranges.append(values[:count])
            reference.append(values[count : count + 3])
            odometry.append(values[count + 3 : count + 6])
            stamps.append(values[count + 6])
    if not ranges:
        raise SystemExit(f"error: no FLASER line in '{path}', expected a log in CARMEN's format")
    measured = np.array(ranges, dtype=np.float32)
    measured[measured >= _FARTHEST] = np.inf
    count = measured.shape[1]
    half = math.pi / 2.0
    # 180 readings are the middles of as many degrees, 181 or 361 begin and end at the sides.
    angles = np.linspace(-half, half, count) if count % 2 else -half + math.pi / count * (np.arange(count) + 0.5)
    log = Log(
        name=path.name.split(".")[0],
        stamps=np.array(stamps),
        ranges=measured,
        angles=angles,
        mount=Pose2(0.0, 0.0, 0.0),
        range_limits=(0.05, _FARTHEST),
        odometry=np.array(reference),
        reference=np.array(reference),
    )
    return with_odometry_noise(log, seed)
