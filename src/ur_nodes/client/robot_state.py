"""Pose, velocity and newest scan of a robot in the map frame, from transforms and laser scans."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import mount_of_pose, points_of_scan
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Scan

SILENT = 3.0
"""Seconds without a transform of the robot after which its pose is out of date."""

_SPEED_WINDOW = 0.2  # s


class RobotState:
    """The robot as its transforms and its lidar show it. Reads may come from any thread."""

    def __init__(self, node: Node, map_frame: str, base_frame: str) -> None:
        self._node, self._map_frame, self._base_frame = node, map_frame, base_frame
        self._tree = node.transforms
        self._stamp: float | None = None
        self._moved_at = -math.inf
        self._scan: tuple[str, NDArray[np.float64]] | None = None
        self._tree.watch(self._note_transform)
        node.subscribe("scan", Scan, self._take_scan)

    @property
    def silent(self) -> bool:
        """True when the robot's newest transform was received too long ago."""
        return self.age() > SILENT

    def age(self) -> float:
        """Seconds since the newest transform of the robot was received; infinite before the first."""
        return self._node.steady() - self._moved_at

    def pose(self) -> Pose2 | None:
        """Return the newest pose in the map frame."""
        return self.place(self._base_frame)

    def place(self, frame: str) -> Pose2 | None:
        """Return the newest pose of a frame in the map frame."""
        return self._tree.find_planar(self._map_frame, frame)

    def velocity(self) -> tuple[float, float]:
        """Return the mean velocity over the last moments, ahead in m/s and turning in rad/s; 0 when silent."""
        return (0.0, 0.0) if self.silent else self._tree.velocity(self._base_frame, _SPEED_WINDOW)

    def scan(self) -> NDArray[np.float64] | None:
        """Return the hits (n, 2) of the newest scan in the map frame, in m."""
        if self._scan is None:
            return None
        parent, points = self._scan
        place = self.place(parent)
        return place.transform_points(points) if place else None

    def _note_transform(self) -> None:
        stamp = self._tree.newest(self._base_frame)
        if stamp is not None and stamp != self._stamp:
            self._stamp, self._moved_at = stamp, self._node.steady()

    def _take_scan(self, scan: Scan) -> None:
        # Held in the base's parent, so that a robot that turns does not drag the scan along until the next one.
        parent = self._tree.parent(self._base_frame) or self._base_frame
        pose = self._tree.find(parent, scan.frame)
        if pose is not None:
            self._scan = (parent, points_of_scan(scan, mount_of_pose(pose)))
