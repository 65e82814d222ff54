"""Sonars: the nearest surface in a cone, found with a fan of rays against the shapes of a MuJoCo model."""

import math

import mujoco
import numpy as np

from ur.robot.base import Sonars
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Range
from ur_nodes.simulator.mujoco_model import SONAR_GROUPS
from ur_nodes.simulator.scenery import rotation_axes
from ur_nodes.simulator.sensors.flat_rays import Floats, cast_rays, measured_ranges
from ur_nodes.simulator.sensors.sense import Noise, Send, Sense, Site

ROW_RAYS = 17  # side by side: walls and obstacles are upright
CONE_RAYS = 32  # over the whole cone: table tops


class SonarRing:
    """The sonars of one robot, in the order of the base's file. They detect what lidars do, and glass."""

    def __init__(self, model: mujoco.MjModel, sonars: Sonars, robot: int) -> None:
        self._model, self._sonars = model, sonars
        self._body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"robot_{robot}")
        poses = [sonar.pose for sonar in sonars.at]
        self._places = np.array([pose[:3] for pose in poses], np.float64).reshape(-1, 3)
        fan = cone_rays(sonars.field_of_view)
        self._fans = [fan @ rotation_axes(pose[3:]) for pose in poses]
        self._reach = sonars.range_max + 6.0 * sonars.noise

    def listen(self, data: mujoco.MjData, noise: Floats) -> Floats:
        """Ranges (m), shape (sonars,), with `noise` (standard normal, same shape) scaled to the sonars'.

        After REP 117: +inf where nothing is within `range_max`, -inf where something is nearer than `range_min`.
        """
        sonars = self._sonars
        turn = data.xmat[self._body].reshape(3, 3).T
        places = data.xpos[self._body] + self._places @ turn
        directions = zip(places, self._fans, strict=True)
        nearest = np.array([self._nearest(data, place, fan @ turn) for place, fan in directions])
        return measured_ranges(nearest, sonars.noise * noise, (sonars.range_min, sonars.range_max))

    def _nearest(self, data: mujoco.MjData, point: Floats, rays: Floats) -> float:
        distances = cast_rays(self._model, data, point, rays, self._body, self._reach, SONAR_GROUPS)
        hits = distances[distances >= 0.0]
        return float(hits.min()) if hits.size else math.inf


def cone_rays(field_of_view: float) -> Floats:
    """Unit vectors within a cone about +x whose opening angle is `field_of_view` (rad), shape (rays, 3).

    A row in the x-y plane from edge to edge, and a sunflower over the cone (Vogel's spiral: the golden angle apart).
    """
    half = field_of_view / 2.0
    across = np.linspace(-half, half, ROW_RAYS)
    row = np.stack([np.cos(across), np.sin(across), np.zeros(ROW_RAYS)], axis=1)
    number = np.arange(1, CONE_RAYS + 1)
    off = half * np.sqrt(number / CONE_RAYS)
    round_axis = number * math.pi * (3.0 - math.sqrt(5.0))
    cone = np.stack([np.cos(off), np.sin(off) * np.cos(round_axis), np.sin(off) * np.sin(round_axis)], axis=1)
    rays: Floats = np.concatenate([row, cone])
    return rays


class SonarSense(Sense):
    """The sonars of one robot."""

    placed = True

    def __init__(self, sonars: Sonars, site: Site) -> None:
        self._sonars, self._site, self.rate = sonars, site, sonars.rate
        self._ring = SonarRing(site.physics.model, sonars, site.robot)
        self._noise = Noise(site.key)
        self.begin()

    def begin(self) -> None:
        """Begin with the first noise."""
        self._count = 0

    def sample(self, time: float) -> None:  # noqa: ARG002 - they are due at their rate
        """Count the reading: its noise is that of its number."""
        self._count += 1

    def ranges(self) -> Floats:
        """Return the ranges (m), in the order of the base's file; see SonarRing.listen."""
        return self._ring.listen(self._site.physics.data, self._noise.draw(self._count, len(self._sonars.at)))

    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:
        """Open their one topic."""
        publisher = node.publish(prefix + self._sonars.topic, Range, quality)
        limits = self._sonars.field_of_view, self._sonars.range_min, self._sonars.range_max

        def send(_time: float, stamp: int) -> None:
            if publisher.subscribers():
                for sonar, value in zip(self._sonars.at, self.ranges().tolist(), strict=True):
                    publisher.send(Range(stamp, prefix + sonar.frame, value, *limits))

        return send


SENSE = SonarSense
