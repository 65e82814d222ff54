"""The lidars of a robot: their readings as one scan in the robot's frame."""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount, directions_of_scan
from ur_nodes.ports import values
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.scan_feed import SILENCE, ScanFeed
from ur_nodes.slam.gmapping.settings import GmappingSettings
from ur_nodes.slam.matching.scan import MapScan, join_scans, make_scan

_APART = 0.15  # s between scans of two lidars that are joined
_KEPT = 5  # scans of each of the others
_MISSED = 10  # in a row before it is reported: the first ones come before the connection


@dataclass(frozen=True, slots=True, eq=False)
class LidarReading:
    """A scan and the mount of its lidar; `moved` is the robot's pose then in that of the first reading, None: equal."""

    scan: values.Scan
    mount: SensorMount
    moved: Pose2 | None = None


class Lidars:
    """Finds the scans that belong together: those of the other lidars nearest in time to one of the first."""

    def __init__(self, node: Node, feed: ScanFeed, others: Sequence[str]) -> None:
        """`others` are the topics of the other lidars; they are subscribed to."""
        self._node, self._feed = node, feed
        self._others: dict[str, deque[values.Scan]] = {topic: deque(maxlen=_KEPT) for topic in others}
        self._missed = dict.fromkeys(others, 0)  # scans in a row that had none of this topic beside them
        for topic, newest in self._others.items():
            feed.beside(topic, newest.append)

    def readings(self, scan: values.Scan, odometry: Pose2 | None) -> list[LidarReading]:
        """Return a scan of the first lidar, and those of the others at that time; none while its mount is unknown."""
        mount = self._feed.mount(scan.frame)
        if mount is None:
            return []
        found = [LidarReading(scan, mount)]
        for topic, scans in self._others.items():
            other = min(scans, key=lambda each: abs(each.stamp - scan.stamp), default=None)
            if other is None or abs(other.stamp - scan.stamp) > _APART * SECOND:
                self._missed[topic] += 1
                if self._missed[topic] >= _MISSED:
                    text = f"no scan on {topic} at the time of that on scan; it is left out"
                    self._node.log.warn(text, every=SILENCE)
                continue
            self._missed[topic] = 0
            mount = self._feed.mount(other.frame)
            then = self._feed.odometry(other.stamp) if odometry else None
            if mount is None or (odometry and then is None):
                continue
            found.append(LidarReading(other, mount, odometry.inverse().compose(then) if odometry and then else None))
        return found


def join_readings(readings: Sequence[LidarReading], settings: GmappingSettings) -> MapScan:
    """Make the scan of readings, at least one, in the robot's frame at the time of the first."""
    scans = [(_make(each, settings), each.moved) for each in readings]
    return join_scans([scan.moved(moved) if moved else scan for scan, moved in scans])


def _make(reading: LidarReading, settings: GmappingSettings) -> MapScan:
    scan = reading.scan
    far = min(settings.max_range or math.inf, scan.range_max)
    # As upstream: beams without an echo are free floor only where less than the lidar's range is to be used.
    free = settings.max_usable if settings.max_usable < far else 0.0
    return make_scan(scan.ranges, directions_of_scan(scan), (scan.range_min, far), reading.mount, free)
