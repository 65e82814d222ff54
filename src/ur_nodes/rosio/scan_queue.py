"""Scans that wait until the odometry of their time is known, and the loop that uses them."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

import rospy
from sensor_msgs.msg import LaserScan

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import Mount, mount_of_pose
from ur_nodes.rosio.frames import Frames

LONGEST_QUEUE = 30  # scans
SILENCE = 15.0  # s without a scan before the log reports it, and again after as long


class ScanQueue:
    """Callbacks add scans and report transforms; one thread takes the newest scan that can be used.

    Odometry is the transform from `odom_frame` to `base_frame`. Without an `odom_frame` ('') no scan waits.
    """

    def __init__(self, odom_frame: str, base_frame: str, ignored: frozenset[str] = frozenset()) -> None:
        """`ignored` are the children of transforms that the node itself sends."""
        self._odom_frame, self._base_frame = odom_frame, base_frame
        self._mounts: dict[str, Mount] = {}
        self._scans: deque[LaserScan] = deque(maxlen=LONGEST_QUEUE)
        self._news = threading.Condition()  # guards _scans
        self.frames = Frames(self._wake, ignored=ignored)

    def odometry(self, stamp: rospy.Time) -> Pose2 | None:
        """The pose of the base in the odometry's frame at a time (zero: the newest), None when it is not known."""
        if not self._odom_frame:
            return None
        found = self.frames.find(self._odom_frame, self._base_frame, stamp)
        return found.planar() if found else None

    def mount(self, frame: str) -> Mount | None:
        """The mount of a lidar by its frame, which does not move on the robot; None while it is not known."""
        if frame not in self._mounts:
            found = self.frames.find(self._base_frame, frame, rospy.Time(0))
            if not found:
                return None
            self._mounts[frame] = mount_of_pose(found)
        return self._mounts[frame]

    def add(self, message: LaserScan) -> None:
        """Take a scan in; of more than LONGEST_QUEUE the oldest goes."""
        with self._news:
            self._scans.append(message)
            self._news.notify()

    def take(self, patience: float = 1.0) -> tuple[LaserScan, Pose2 | None] | None:
        """The newest scan whose odometry is known, with it, after at most `patience` s; older ones go with it.

        The odometry is None only where there is no odometry's frame.
        """
        with self._news:
            for index in range(len(self._scans) - 1, -1, -1):
                scan = self._scans[index]
                odometry = self.odometry(scan.header.stamp)
                if odometry or not self._odom_frame:
                    for _ in range(index + 1):
                        self._scans.popleft()
                    return scan, odometry
            self._news.wait(patience)
        return None

    def serve(self, use: Callable[[LaserScan, Pose2 | None], None]) -> None:
        """Use scans until the node ends. The log explains a silence."""
        quiet_since = rospy.get_time()
        while not rospy.is_shutdown():
            ready = self.take()
            now = rospy.get_time()
            if ready:
                quiet_since = now
                use(*ready)
            elif not 0.0 <= now - quiet_since <= SILENCE:
                quiet_since = now
                self._explain_silence()

    def _wake(self) -> None:
        if self._scans:
            with self._news:
                self._news.notify()

    def _explain_silence(self) -> None:
        topic = rospy.resolve_name("scan")
        if not self._scans:
            rospy.logwarn("no scan on %s for %g s; is the lidar driver running?", topic, SILENCE)
        elif not self.odometry(rospy.Time(0)):
            rospy.logwarn("no transform from %s to %s, expected one", self._base_frame, self._odom_frame)
        else:
            rospy.logwarn("%s and tf timestamps do not overlap; do all nodes use the same clock?", topic)
