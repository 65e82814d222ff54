"""The work of the node `slam_gmapping` on scans."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.gmapping.lidars import LidarReading, join_readings
from ur_nodes.slam.gmapping.settings import GmappingSettings
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.mapper import MapEstimate
from ur_nodes.slam.tracker import MapTracker


@dataclass(frozen=True, slots=True, eq=False)
class SlamStep:
    """The outcome of a scan: an estimate, and `odometry` as it was given.

    `correction` is the pose of the odometry's frame in the map, or of the robot without odometry; None while `lost`.
    `poses` are those, at least two, that fit equally while the robot is lost; else none. `first`: the map begins.
    `mount` is the pose of the lidar on the robot, None where there are several.
    """

    estimate: MapEstimate
    odometry: Pose2 | None
    correction: Pose2 | None
    lost: bool
    poses: Sequence[Pose2]
    first: bool
    mount: Pose2 | None = None


class Slam:
    """Makes a map. Its methods take long, and are called as jobs of one lane."""

    def __init__(self, settings: GmappingSettings) -> None:
        self._settings = settings
        self._mapper = MapTracker(settings.mapper)

    def use(self, settings: GmappingSettings) -> None:
        """Use changed settings from the next scan on."""
        self._settings = settings
        self._mapper.use(settings.mapper)

    def restore(self, stored: MapState) -> None:
        """Start with an existing map."""
        self._mapper.restore(stored.poses, stored.edges, stored.scans)

    def step(self, readings: Sequence[LidarReading], odometry: Pose2 | None, heading: float | None) -> SlamStep:
        """Use the scans, at least one, of one moment."""
        scan = join_readings(readings, self._settings)
        mapper = self._mapper
        first = not mapper.scans
        estimate = mapper.add_scan(scan, odometry, heading)
        known = estimate.pose.compose(odometry.inverse()) if odometry else estimate.pose
        places = mapper.candidates() if mapper.lost else []
        mount = readings[0].mount.planar() if len(readings) == 1 else None
        return SlamStep(estimate, odometry, None if mapper.lost else known, mapper.lost, places, first, mount)

    def state(self) -> MapState:
        """Return the present map."""
        mapper = self._mapper
        return MapState(list(mapper.keyframes), list(mapper.edges), list(mapper.scans), mapper.drives())


def entropy(estimate: MapEstimate) -> float:
    """Return the differential entropy of the pose around the estimate (m and rad), higher when it is less certain."""
    sign, logarithm = np.linalg.slogdet(2.0 * math.pi * math.e * estimate.covariance)
    return 0.5 * float(logarithm) if sign > 0 else -math.inf
