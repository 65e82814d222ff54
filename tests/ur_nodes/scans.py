"""Scans as tests make them, with the fields of sensor_msgs/LaserScan."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class FakeScan(NamedTuple):
    """Ranges (n) in m of a lidar that looks all round."""

    ranges: NDArray[np.floating]
    range_min: float = 0.1
    range_max: float = 12.0
    angle_min: float = -math.pi
    angle_increment: float = math.tau / 360.0
