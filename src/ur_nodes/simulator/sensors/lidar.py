"""A planar lidar: beams that end at the shapes of a MuJoCo model."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from ur.robot.base import Lidar
from ur_nodes.simulator.sensors.flat_rays import PlanarBeams, UprightShapes
from ur_nodes.simulator.sensors.rays import Floats, RayCaster, measured_ranges


class LidarBeams:
    """The beams of one lidar, in the order of a LaserScan: from `angle_min` to `angle_max`, counter-clockwise.

    They are cast in the plane of `shapes` where that is the same, else in space.
    """

    def __init__(self, model: mujoco.MjModel, lidar: Lidar, robot: int, shapes: UprightShapes | None = None) -> None:
        self._lidar = lidar
        self._shapes = shapes if shapes and shapes.flat else None
        self._site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, f"lidar_{robot}")
        angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples)
        self._beams = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        self._body = int(model.site_bodyid[self._site])
        reach = lidar.range_max + 6.0 * lidar.noise
        self._rays = RayCaster(model, self._body, lidar.samples, reach)
        self._planar = PlanarBeams(lidar.angle_min, float(angles[1] - angles[0]), lidar.samples, reach)

    def cast(self, data: mujoco.MjData, noise: Floats) -> Floats:
        """Ranges (m), shape (samples,), with `noise` (standard normal, same shape) scaled to the lidar's.

        After REP 117: +inf where nothing is within `range_max`, -inf where something is nearer than `range_min`.
        """
        lidar = self._lidar
        distances = self._cast_in_plane(data)
        if distances is None:
            directions = self._beams @ data.site_xmat[self._site].reshape(3, 3).T
            distances = self._rays.cast(data, data.site_xpos[self._site], directions)
        return measured_ranges(distances, lidar.noise * noise, (lidar.range_min, lidar.range_max))

    def _cast_in_plane(self, data: mujoco.MjData) -> Floats | None:
        place, turn = data.site_xpos[self._site], data.site_xmat[self._site]
        if not self._shapes or not self._shapes.is_at_height(place, turn):
            return None
        sides = self._shapes.sides(data, self._body)
        if sides is None:
            return None
        return self._planar.cast(sides, (float(place[0]), float(place[1])), math.atan2(turn[3], turn[0]))


def make_lidars(model: mujoco.MjModel, lidar: Lidar, robots: int) -> list[LidarBeams]:
    """The lidars of robots, by number."""
    shapes = UprightShapes(model, lidar.pose[2])
    return [LidarBeams(model, lidar, robot, shapes) for robot in range(robots)]
