"""A planar lidar: rays cast against the shapes of a MuJoCo model."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from ur.robot.base import Lidar
from ur_nodes.simulator.model import LIDAR_GROUPS

Floats = npt.NDArray[np.float64]


class RayCaster:
    """The beams of one lidar, in the order of a LaserScan: from `angle_min` to `angle_max`, counter-clockwise."""

    def __init__(self, model: Any, lidar: Lidar, robot: int) -> None:
        self._model = model
        self._lidar = lidar
        self._site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"lidar_{robot}")
        self._body = int(model.site_bodyid[self._site])
        angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples)
        self._beams = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        self._groups = np.array(LIDAR_GROUPS, np.uint8)
        self._hit = np.zeros(lidar.samples, np.int32)
        self._distance = np.zeros(lidar.samples)

    def cast(self, data: Any, noise: Floats) -> Floats:
        """Ranges (m), shape (samples,), with `noise` (standard normal, same shape) scaled to the lidar's.

        After REP 117: +inf where nothing is within `range_max`, -inf where something is nearer than `range_min`.
        """
        lidar = self._lidar
        directions = (self._beams @ data.site_xmat[self._site].reshape(3, 3).T).ravel()
        mujoco.mj_multiRay(
            self._model,
            data,
            data.site_xpos[self._site],
            directions,
            self._groups,
            1,  # walls too
            self._body,
            self._hit,
            self._distance,
            None,
            lidar.samples,
            lidar.range_max + 6.0 * lidar.noise,
        )
        ranges = self._distance + lidar.noise * noise
        missed = (self._distance < 0.0) | (ranges > lidar.range_max)
        ranges[ranges < lidar.range_min] = -np.inf
        ranges[missed] = np.inf
        return ranges
