"""The sensors of a base as the obstacle stop uses them: their fields of view, rates, and the area before the base."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur.robot.base import Base
from ur_nodes.geometry.hull import Hull
from ur_nodes.geometry.rigid import from_angles
from ur_nodes.geometry.scan import SensorMount

Floats = NDArray[np.float64]
Side = Literal["ahead", "behind", "on the left", "on the right"]

_COVERED = 0.9  # of a side: then a direction is seen
_STRIP = 21  # positions along a side of a base
_NEAREST, _FURTHEST, _STEP = 0.05, 0.6, 0.05  # m before the outline


@dataclass(frozen=True, slots=True, eq=False)
class RangeSensor:
    """A lidar or a sonar on the base.

    It sees `start` to `end` (rad in its frame, counter-clockwise) and up to `reach` (m), each `period` s. `label` is
    its name in messages. `views` are which of the positions along each side of the base it sees.
    """

    name: str
    label: str
    mount: SensorMount
    start: float
    end: float
    reach: float
    period: float
    views: Mapping[Side, NDArray[np.bool_]]

    def sees(self, points: Floats, turned: float = 0.0) -> NDArray[np.bool_]:
        """Return which points (n, 2) of the base's frame lie in its field of view.

        With a base that has `turned` (rad) from its first to its last beam, in the base's frame in between.
        """
        half = turned / 2.0 * self.mount.rotation[2, 2]
        return _sees(points, self.mount, (self.start - half, self.end + half), self.reach)


def _sees(points: Floats, mount: SensorMount, span: tuple[float, float], reach: float) -> NDArray[np.bool_]:
    local = (points - mount.offset[:2]) @ mount.rotation[:2, :2]
    angles = (np.arctan2(local[:, 1], local[:, 0]) - span[0]) % (2.0 * math.pi)
    seen: NDArray[np.bool_] = (angles <= span[1] - span[0]) & (np.hypot(*local.T) <= reach)
    return seen


@lru_cache(maxsize=64)
def covers(sensors: tuple[RangeSensor, ...], side: Side) -> bool:
    """Return whether sensors together cover nearly a whole side of a base."""
    return bool(sensors) and float(np.any([each.views[side] for each in sensors], axis=0).mean()) >= _COVERED


def sensors_of(base: Base, hull: Hull, *, sonars: bool = True) -> tuple[RangeSensor, ...]:
    """The lidar and the sonars of a base. A sensor tilted by more than 45 degrees sees no obstacle."""
    found = []
    if base.lidar:
        lidar, turn = base.lidar, 2.0 * math.pi
        step = (lidar.angle_max - lidar.angle_min) / max(1, lidar.samples - 1)
        span = lidar.angle_min, lidar.angle_min + min(turn, lidar.angle_max - lidar.angle_min + step)
        found.append((lidar.topic, "scan", lidar.pose, span, lidar.range_max, 1.0 / lidar.rate))
    if base.sonars and sonars:
        half = base.sonars.field_of_view / 2.0
        found += [
            (sonar.frame, sonar.frame, sonar.pose, (-half, half), base.sonars.range_max, 1.0 / base.sonars.rate)
            for sonar in base.sonars.at
        ]
    return tuple(
        _sensor(hull, name, label, pose, span, reach, period)
        for name, label, pose, span, reach, period in found
        if abs(math.cos(pose[4])) >= math.sqrt(0.5)
    )


def _sensor(
    hull: Hull, name: str, label: str, pose: tuple[float, ...], span: tuple[float, float], reach: float, period: float
) -> RangeSensor:
    rigid = from_angles(pose[:3], pose[3:])
    mount = SensorMount(rigid[:3, :3], rigid[:3, 3])
    views = {
        side: np.array([_sees(column, mount, span, reach).any() for column in strip])
        for side, strip in _strips(hull).items()
    }
    return RangeSensor(name, label, mount, *span, reach, period, views)


def _strips(hull: Hull) -> Mapping[Side, Floats]:
    """Return points beside each side of the outline (positions along it, distances, 2)."""
    (low_x, low_y), (high_x, high_y) = hull.corners.min(axis=0), hull.corners.max(axis=0)
    across, along = np.linspace(low_y, high_y, _STRIP), np.linspace(low_x, high_x, _STRIP)
    away = np.arange(_NEAREST, _FURTHEST, _STEP)
    return {
        "ahead": np.stack(np.meshgrid(across, high_x + away, indexing="ij")[::-1], axis=-1),
        "behind": np.stack(np.meshgrid(across, low_x - away, indexing="ij")[::-1], axis=-1),
        "on the left": np.stack(np.meshgrid(along, high_y + away, indexing="ij"), axis=-1),
        "on the right": np.stack(np.meshgrid(along, low_y - away, indexing="ij"), axis=-1),
    }
