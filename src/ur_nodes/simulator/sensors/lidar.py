"""A planar lidar: rays cast against the shapes of a MuJoCo model."""

from __future__ import annotations

import mujoco
import numpy as np

from ur.robot.base import Lidar
from ur_nodes.simulator.sensors.rays import Floats, RayCaster, measured_ranges


class LidarBeams:
    """The beams of one lidar, in the order of a LaserScan: from `angle_min` to `angle_max`, counter-clockwise."""

    def __init__(self, model: mujoco.MjModel, lidar: Lidar, robot: int) -> None:
        self._lidar = lidar
        self._site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"lidar_{robot}")
        angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples)
        self._beams = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        body = int(model.site_bodyid[self._site])
        self._rays = RayCaster(model, body, lidar.samples, lidar.range_max + 6.0 * lidar.noise)

    def cast(self, data: mujoco.MjData, noise: Floats) -> Floats:
        """Ranges (m), shape (samples,), with `noise` (standard normal, same shape) scaled to the lidar's.

        After REP 117: +inf where nothing is within `range_max`, -inf where something is nearer than `range_min`.
        """
        lidar = self._lidar
        directions = self._beams @ data.site_xmat[self._site].reshape(3, 3).T
        distances = self._rays.cast(data, data.site_xpos[self._site], directions)
        return measured_ranges(distances, lidar.noise * noise, (lidar.range_min, lidar.range_max))
