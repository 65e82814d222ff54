"""Pose, velocity and newest scan of a robot in the map frame, from tf and laser scans."""

from __future__ import annotations

import math
import threading
import time
from typing import Any

import numpy as np
import rospy
from numpy.typing import NDArray
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import mount_of_pose, points_of_scan
from ur_nodes.geometry.transform_tree import TransformError
from ur_nodes.rosio.frames import Frames

SILENT = 3.0
"""Seconds without a transform of the robot after which its pose is out of date."""

_SPEED_WINDOW = 0.2  # s


class RobotState:
    """The robot as tf and its lidar show it; subscribes when it is made. Methods may be called from any thread."""

    def __init__(self, map_frame: str, base_frame: str) -> None:
        self._map_frame, self._base_frame = map_frame, base_frame
        self._lock = threading.Lock()
        self._stamp: float | None = None
        self._moved_at = -math.inf
        self._scan: tuple[str, NDArray[np.float64]] | None = None
        with self._lock:  # a first transform waits for the assignment
            self._frames = Frames(self._note_transform)
        rospy.Subscriber("scan", numpy_msg(LaserScan), self._take_scan, queue_size=1)

    def silent(self, now: float) -> bool:
        """True when the robot's newest transform was received too long ago; `now` is time.monotonic()."""
        return self.age(now) > SILENT

    def age(self, now: float) -> float:
        """Seconds since the newest transform of the robot was received; `now` is time.monotonic()."""
        return now - self._moved_at

    def pose(self) -> Pose2 | None:
        """Return the newest pose in the map frame."""
        return self.place(self._base_frame)

    def place(self, frame: str) -> Pose2 | None:
        """Return the newest pose of a frame in the map frame."""
        try:
            return self._frames.pose(self._map_frame, frame)
        except TransformError:
            return None

    def velocity(self, now: float) -> tuple[float, float]:
        """Return the mean velocity over the last moments, ahead in m/s and turning in rad/s; 0 when silent."""
        return (0.0, 0.0) if self.silent(now) else self._frames.velocity(self._base_frame, _SPEED_WINDOW)

    def scan(self) -> NDArray[np.float64] | None:
        """Return the hits (n, 2) of the newest scan in the map frame, in m."""
        if self._scan is None:
            return None
        parent, points = self._scan
        try:
            return self._frames.pose(self._map_frame, parent).transform_points(points)
        except TransformError:
            return None

    def _note_transform(self) -> None:
        with self._lock:
            stamp = self._frames.newest(self._base_frame)
            if stamp is not None and stamp != self._stamp:
                self._stamp, self._moved_at = stamp, time.monotonic()

    def _take_scan(self, message: Any) -> None:
        # Held in the base's parent, so that a robot that turns does not drag the scan along until the next one.
        parent = self._frames.parent(self._base_frame) or self._base_frame
        try:
            mount = mount_of_pose(self._frames.lookup(parent, message.header.frame_id))
        except TransformError:
            return
        self._scan = (parent, points_of_scan(message, mount))
