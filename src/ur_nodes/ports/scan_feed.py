"""Scans of all nodes, with the time that they took: they wait until the odometry of their time is known."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount, mount_of_pose
from ur_nodes.geometry.scan_time import ranges_at_one_moment, turn_time, velocity_between
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.values import Scan

LONGEST_QUEUE = 30  # scans
SILENCE = 15.0  # s without a scan before the log reports it, and again after as long
_ARRIVAL = 10.0  # s: the first scan may come before the transforms of a node that takes long to start


class ScanFeed:
    """Subscribes to `topic`, and calls `use` with the newest usable scan; older ones are dropped.

    Odometry is the transform from `odom_frame` to `base_frame` at the scan's time; a head that turns measures a scan
    for a while: it is given as if measured at the middle of it, as far as odometry is known. Without an `odom_frame`
    ('') no scan waits, and its odometry is None. Every `throttle`th scan is used. `reports`: silence is logged.
    With a `patience` (s) a scan without odometry by then is given as it is, with the newest odometry.
    """

    def __init__(
        self,
        node: Node,
        odom_frame: str,
        base_frame: str,
        use: Callable[[Scan, Pose2 | None], None],
        throttle: int = 1,
        *,
        topic: str = "scan",
        reports: bool = True,
        patience: float = 0.0,
    ) -> None:
        self.odom_frame, self.base_frame = odom_frame, base_frame
        self.newest: Scan | None = None
        """The scan that arrived last, whether its odometry is known or not."""
        self._node, self._topic = node, topic
        self._throttle, self._count = throttle, 0
        self._held = False
        self._use = use
        self._mounts: dict[str, SensorMount] = {}
        self._asked: dict[str, int] = {}  # when a mount was first asked for (ns), by frame
        self._scans: deque[Scan] = deque(maxlen=LONGEST_QUEUE)
        self._quiet_since = node.now()
        self._beside: list[ScanFeed] = []
        node.transforms.watch(self.pass_on)
        node.subscribe(topic, Scan, self._add)
        if reports:
            node.every(1.0, self._explain_silence)
        if patience:
            node.every(patience, lambda: self._give_up(patience))

    def beside(self, topic: str, use: Callable[[Scan], None]) -> None:
        """Feed the scans of another lidar of the robot, too."""
        frames = self.odom_frame, self.base_frame
        self._beside.append(ScanFeed(self._node, *frames, lambda scan, _: use(scan), topic=topic, reports=False))

    def odometry(self, stamp: int = 0) -> Pose2 | None:
        """Return the pose of the base in the odometry's frame at a time (0: the newest); None if unknown."""
        return self._node.transforms.find_planar(self.odom_frame, self.base_frame, stamp) if self.odom_frame else None

    def mount(self, frame: str) -> SensorMount | None:
        """Return the mount of a lidar by its frame, which is fixed on the robot; None if unknown, with a log later."""
        found = self.find_mount(frame)
        now = self._node.now()
        if found is None and now - self._asked.setdefault(frame, now) > _ARRIVAL * SECOND:
            self._node.log.warn(f"no transform from {frame} to {self.base_frame}, expected one", every=SILENCE)
        return found

    def find_mount(self, frame: str) -> SensorMount | None:
        """Return the mount of a lidar by its frame; None if unknown."""
        if frame not in self._mounts:
            if not (found := self._node.transforms.find(self.base_frame, frame)):
                return None
            self._mounts[frame] = mount_of_pose(found)
        return self._mounts[frame]

    def hold(self) -> None:
        """Hold back scans until `release`: the last one is still in use."""
        self._held = True

    def release(self) -> None:
        """Pass on scans again."""
        self._held = False
        self.pass_on()

    def _add(self, scan: Scan) -> None:
        """Add a scan; of more than LONGEST_QUEUE the oldest is dropped."""
        self._count += 1
        self.newest = scan
        if self._count % self._throttle == 0:
            self._scans.append(at_its_middle(scan))
            self.pass_on()

    def pass_on(self) -> None:
        """Use the newest scan whose odometry is known by now."""
        for feed in self._beside:  # a scan is used with those of its time
            feed.pass_on()
        if self._held:
            return
        for index in range(len(self._scans) - 1, -1, -1):
            scan = self._scans[index]
            odometry = self.odometry(scan.stamp)
            if odometry or not self.odom_frame:
                for _ in range(index + 1):
                    self._scans.popleft()
                self._quiet_since = self._node.now()
                self._use(self._at_one_moment(scan, odometry), odometry)
                return

    def _give_up(self, patience: float) -> None:
        if self._scans and not self._held and self._node.now() - self._scans[-1].stamp > patience * SECOND:
            scan = self._scans.pop()
            self._scans.clear()
            self._use(scan, self.odometry())

    def _at_one_moment(self, scan: Scan, middle: Pose2 | None) -> Scan:
        """Return the scan without the robot's motion during its measurement; unchanged if that is unknown."""
        turn = turn_time(scan)
        half = abs(turn) / 2.0
        if middle is None or not half:
            return scan
        begun, mount = self.odometry(scan.stamp - round(half * SECOND)), self.find_mount(scan.frame)
        if begun is None or mount is None:
            return scan
        ended = self.odometry(scan.stamp + round(half * SECOND))
        before = velocity_between(begun, middle, half)
        after = velocity_between(middle, ended, half) if ended else before
        times = np.linspace(-turn / 2.0, turn / 2.0, len(scan.ranges))
        velocity = np.where(times < 0.0, np.array(before)[:, None], np.array(after)[:, None])
        return replace(
            scan,
            ranges=ranges_at_one_moment(
                np.asarray(scan.ranges), scan.angle_min, scan.angle_increment, times, velocity, mount
            ),
            intensities=np.zeros(0, np.float32),
            time_increment=0.0,
        )

    def _explain_silence(self) -> None:
        now = self._node.now()
        if 0 <= now - self._quiet_since <= SILENCE * SECOND:
            return
        self._quiet_since = now
        topic, log = self._node.resolve(self._topic), self._node.log
        if not self._scans:
            log.warn(f"no scan on {topic} for {SILENCE:g} s; is the lidar driver running?")
        elif not self.odometry():
            log.warn(f"no transform from {self.base_frame} to {self.odom_frame}, expected one")
        else:
            log.warn(f"{topic} and tf timestamps do not overlap; do all nodes use the same clock?")


def at_its_middle(scan: Scan) -> Scan:
    """Return the scan with its stamp halfway between first and last beam, so that motion shifts both halves alike."""
    half = round(turn_time(scan) / 2.0 * SECOND)
    return replace(scan, stamp=scan.stamp + half) if half else scan


def feed_beams(node: Node, topic: str, use: Callable[[Scan, float], None]) -> None:
    """Call `use` with each newest scan as it is, for what cannot wait for odometry, and with its `turn_time`."""
    node.subscribe(topic, Scan, lambda scan: use(scan, turn_time(scan)))
