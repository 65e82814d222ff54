"""The lidars of a robot: messages to scans in its frame, those of several lidars joined."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
import rospy
from numpy.typing import NDArray
from sensor_msgs.msg import LaserScan

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import directions_of_scan
from ur_nodes.rosio.scan_queue import SILENCE, ScanQueue
from ur_nodes.slam.gmapping_settings import GmappingSettings
from ur_nodes.slam.matching.scan import Scan, join_scans, make_scan

_APART = 0.15  # s between scans of two lidars that are joined
_KEPT = 5  # scans of each of the others
_MISSED = 10  # in a row before it is reported: the first ones come before the connection


class Lidars:
    """Makes scans. That of the first lidar sets the time; the nearest ones of the others are moved to it."""

    def __init__(self, settings: GmappingSettings, queue: ScanQueue, others: Sequence[str]) -> None:
        """`others` are the topics of the other lidars; they are subscribed to."""
        self._settings, self._queue = settings, queue
        self._others: dict[str, deque[LaserScan]] = {topic: deque(maxlen=_KEPT) for topic in others}
        self._missed = dict.fromkeys(others, 0)  # scans in a row that had none of this topic beside them
        for topic, newest in self._others.items():
            rospy.Subscriber(topic, LaserScan, newest.append, queue_size=2, tcp_nodelay=True)

    def scan(self, message: LaserScan, odometry: Pose2 | None) -> Scan | None:
        """The scan of a message of the first lidar, and of the others at that time; None: its mount is not known."""
        first = self._make(message)
        if first is None:
            return None
        joined = [first]
        for topic, messages in self._others.items():
            other = min(messages.copy(), key=lambda each: _apart(each, message), default=None)
            if other is None or _apart(other, message) > _APART:
                self._missed[topic] += 1
                if self._missed[topic] >= _MISSED:
                    rospy.logwarn_throttle(SILENCE, "no scan on %s at the time of that on scan; it is left out", topic)
                continue
            self._missed[topic] = 0
            scan = self._make(other)
            then = self._queue.odometry(other.header.stamp) if odometry else None
            if scan is None or (odometry and then is None):
                continue
            joined.append(scan.moved(odometry.inverse().compose(then)) if odometry and then else scan)
        return join_scans(joined)

    def rotation(self, frame: str) -> NDArray[np.float64] | None:
        """The rotation (3, 3) of a frame in the robot's; None while it is not known."""
        mount = self._queue.mount(frame)
        return mount.rotation if mount else None

    def _make(self, message: LaserScan) -> Scan | None:
        mount = self._queue.mount(message.header.frame_id.lstrip("/"))
        if not mount:
            frame, base = message.header.frame_id, self._settings.base_frame
            rospy.logwarn_throttle(SILENCE, f"no transform from {frame} to {base}, expected one")
            return None
        settings = self._settings
        far = min(settings.max_range or math.inf, message.range_max)
        # As upstream: beams without an echo are free floor only where less than the lidar's range is to be used.
        free = settings.max_usable if settings.max_usable < far else 0.0
        ranges = np.array(message.ranges, dtype=np.float32)
        return make_scan(ranges, directions_of_scan(message), (message.range_min, far), mount, free)


def _apart(one: LaserScan, other: LaserScan) -> float:
    return abs(float((one.header.stamp - other.header.stamp).to_sec()))
