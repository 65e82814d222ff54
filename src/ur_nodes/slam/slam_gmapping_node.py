"""The node `slam_gmapping`: a map from a lidar and, where there is one, odometry."""

from __future__ import annotations

import math
import sys
import threading

import numpy as np
import rospy
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Float64

from ur_nodes.geometry.difference import describe_places
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import TransformSender
from ur_nodes.rosio.scan_queue import ScanQueue
from ur_nodes.rosio.shell import run_node
from ur_nodes.slam.gmapping_settings import read_settings
from ur_nodes.slam.gyro import Headings
from ur_nodes.slam.lidars_node import Lidars
from ur_nodes.slam.map_output_node import MapOutput
from ur_nodes.slam.map_state import MapState
from ur_nodes.slam.mapper import Estimate
from ur_nodes.slam.slip import SlipWatch
from ur_nodes.slam.storage.map_storage_node import MapStorage, StorageSettings, read_storage_settings
from ur_nodes.slam.tracker import Tracker

SLIP_SILENCE = 30.0  # s between two reports of wheels that slip


class SlamGmappingNode:
    """Translates messages for a Mapper. A thread takes scans, another one draws the map; callbacks only hand over."""

    def __init__(self) -> None:
        parameters = Parameters()
        self._settings = settings = read_settings(parameters)
        storage = read_storage_settings(parameters)
        self._mapper = Tracker(settings.mapper)
        self._work = threading.Lock()  # guards the mapper and the correction
        self._correction: Pose2 | None = None  # of the odometry's frame in the map, or of the robot without odometry
        self._count = 0
        self._located, self._lost, self._places = True, False, 0  # as reported last
        self._slip = SlipWatch()
        self._turns = threading.Lock()  # guards the yaw rates
        self._headings = Headings()
        self._by_gyro = self._gyro_wrong = False  # as reported last
        self._last: Pose2 | None = None  # odometry at the last scan
        self._child = settings.odom_frame or settings.base_frame
        self._transforms = TransformSender()
        self._entropy = rospy.Publisher("~entropy", Float64, queue_size=1, latch=True)
        self._output = MapOutput(settings, self._state)
        if storage:
            self._store(storage)
        self._queue = ScanQueue(settings.odom_frame, settings.base_frame, frozenset((self._child,)))
        self._lidars = Lidars(settings, self._queue, settings.other_scans)
        rospy.Subscriber("imu", Imu, self._take_imu, queue_size=100, tcp_nodelay=True)
        rospy.Subscriber("scan", LaserScan, self._take_scan, queue_size=2, tcp_nodelay=True)
        for name, run in (("scans", self._run), ("map", self._draw), ("transform", self._broadcast)):
            threading.Thread(target=quiet_at_end(run), name=name, daemon=True).start()

    # -- scans -----------------------------------------------------------------------------------------------------

    def _take_scan(self, message: LaserScan) -> None:
        self._count += 1
        if self._count % self._settings.throttle_scans:
            return
        self._queue.add(message)

    def _run(self) -> None:
        self._queue.serve(self._use_scan)

    def _use_scan(self, message: LaserScan, odometry: Pose2 | None) -> None:
        scan = self._lidars.scan(message, odometry)
        if scan is None:
            return
        first = not self._mapper.scans
        with self._turns:
            heading = self._headings.at(message.header.stamp.to_sec(), odometry) if odometry else None
        with self._work:
            estimate = self._mapper.add_scan(scan, odometry, heading)
            known = estimate.pose.compose(odometry.inverse()) if odometry else estimate.pose
            self._correction = None if self._mapper.lost else known
        self._report(estimate)
        self._watch_wheels(estimate, odometry)
        if odometry:
            self._watch_gyro(estimate)
        self._entropy.publish(Float64(entropy(estimate)))
        if first:
            self._output.publish()

    def _report(self, estimate: Estimate) -> None:
        lost = self._mapper.lost
        if lost or self._lost:
            self._report_search(estimate)
        elif self._located and not estimate.located:
            rospy.logwarn(
                "the scan does not match the map (%.0f %% of it); the map goes on by odometry alone",
                100.0 * estimate.agreement,
            )
        elif estimate.located and not self._located:
            rospy.loginfo("the scan matches the map again")
        self._located, self._lost = estimate.located or lost, lost

    def _watch_wheels(self, estimate: Estimate, odometry: Pose2 | None) -> None:
        last, self._last = self._last, odometry
        if estimate.still:
            return
        if not odometry or not last or not estimate.step or self._mapper.lost:
            self._slip.forget()
            return
        slip = self._slip.add(last.inverse().compose(odometry), estimate.step)
        if slip:
            rospy.logwarn_throttle(
                SLIP_SILENCE,
                "the wheels slip, or somebody moves the robot: odometry reports {:.2f} m and {:.0f} degrees, the scans "
                "{:.2f} m and {:.0f} degrees; the map follows the scans".format(*_sizes(slip.reported, slip.shown)),
            )

    def _take_imu(self, message: Imu) -> None:
        if message.angular_velocity_covariance[0] == -1.0:  # sensor_msgs/Imu: there are no yaw rates
            return
        rotation = self._lidars.rotation(message.header.frame_id.lstrip("/"))
        rates = message.angular_velocity
        if rotation is None or not all(map(math.isfinite, (rates.x, rates.y, rates.z))):
            return
        with self._turns:
            self._headings.gyro.add(message.header.stamp.to_sec(), float(rotation[2] @ (rates.x, rates.y, rates.z)))

    def _watch_gyro(self, estimate: Estimate) -> None:
        if not estimate.still:
            self._headings.judge(None if self._mapper.lost else estimate.step, estimate.wheels)
        if self._headings.trusted != self._by_gyro:
            self._by_gyro = self._headings.trusted
            source = f"the gyroscope on {rospy.resolve_name('imu')} turns" if self._by_gyro else "the wheels turn"
            rospy.loginfo("%s as the scans show: the robot's turns come from there", source)
        if self._headings.contradicted and not self._gyro_wrong:
            self._gyro_wrong = True
            topic = rospy.resolve_name("imu")
            rospy.logwarn("the yaw rates on %s contradict the scans and are not used; is its frame right?", topic)

    def _report_search(self, estimate: Estimate) -> None:
        if not self._mapper.lost:
            rospy.loginfo("found again at (%.2f, %.2f)", *estimate.pose[:2])
            self._places = 0
            return
        if not self._lost:
            rospy.logwarn("lost: looking for the place on the map; drive slowly through places that are mapped")
        places = self._mapper.candidates()
        if len(places) not in (0, self._places):
            grid = self._output.draw(self._state())
            rospy.logwarn("%s", describe_places(grid, places, "drive to another room"))
        self._places = len(places)

    # -- frames ----------------------------------------------------------------------------------------------------

    def _broadcast(self) -> None:
        """Publish the transform from the map, again and again, as of the last scan."""
        period = self._settings.transform_publish_period
        while period > 0.0 and _sleep(period):
            correction = self._correction
            if correction is not None:
                stamp = rospy.Time.now() + rospy.Duration(self._settings.tf_delay)
                self._transforms.send(stamp, (self._settings.map_frame, self._child, correction))

    # -- the map ---------------------------------------------------------------------------------------------------

    def _state(self) -> MapState:
        with self._work:
            mapper = self._mapper
            return MapState(list(mapper.keyframes), list(mapper.edges), list(mapper.scans), mapper.drives())

    def _store(self, settings: StorageSettings) -> None:
        storage = MapStorage(settings, self._state, self._output.draw)
        if storage.continues:
            stored = storage.load()
            self._mapper.restore(stored.poses, stored.edges, stored.scans)
            self._lost = True
            rospy.loginfo("continuing the map '%s'; looking for the place on it", storage.name)
            self._output.publish()
        storage.start(self._state() if storage.continues else None)
        rospy.loginfo("saving the map as '%s', every %g s and at the end", storage.name, settings.every)

    def _draw(self) -> None:
        while _sleep(self._settings.map_update_interval):
            self._output.publish()


def entropy(estimate: Estimate) -> float:
    """The differential entropy of the pose round the estimate (m and rad), higher when it is less certain."""
    sign, logarithm = np.linalg.slogdet(2.0 * math.pi * math.e * estimate.covariance)
    return 0.5 * float(logarithm) if sign > 0 else -math.inf


def _sizes(*motions: Pose2) -> list[float]:
    """The way (m) and the turn (degrees) of each motion."""
    return [size for each in motions for size in (math.hypot(each.x, each.y), math.degrees(each.yaw))]


def _sleep(seconds: float) -> bool:
    """Sleep; False at the end of the node."""
    try:
        rospy.sleep(seconds)
    except rospy.ROSTimeMovedBackwardsException:
        pass
    except rospy.ROSInterruptException:
        return False
    return not rospy.is_shutdown()


def main() -> int:
    """Run until shutdown; exit code 2 when a parameter cannot be used."""
    nodes: list[SlamGmappingNode] = []
    return run_node("slam_gmapping", lambda: nodes.append(SlamGmappingNode()))


if __name__ == "__main__":
    sys.exit(main())
