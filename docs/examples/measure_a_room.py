"""Measure the free floor that the lidar sees from here: its area, and how far it reaches."""

import numpy as np

from ur_nodes.client import Robot

with Robot() as robot:
    scan = robot.scan()
    ranges = np.where(np.isfinite(scan.ranges), scan.ranges, scan.range_max)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    x, y = ranges * np.cos(angles), ranges * np.sin(angles)
    area = 0.5 * abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))
    print(f"{area:.1f} m2 in sight, {np.ptp(x):.1f} m x {np.ptp(y):.1f} m")
