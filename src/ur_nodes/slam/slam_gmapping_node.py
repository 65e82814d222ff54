"""The node `slam_gmapping`: a map from a lidar and, where there is one, odometry."""

import sys

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Imu, Number, Scan, Transform
from ur_nodes.run import run
from ur_nodes.slam.gmapping.lidars import Lidars
from ur_nodes.slam.gmapping.map_output import SCANS, GridMapOutput, SlamReports
from ur_nodes.slam.gmapping.settings import GmappingSettings, read_settings
from ur_nodes.slam.gmapping.slam import Slam, SlamStep, entropy
from ur_nodes.slam.gyro import Headings
from ur_nodes.slam.storage.map_storage import MapStorage, read_storage_settings


class SlamGmappingNode:
    """Connects a `Slam` to topics. It runs on a worker, so that the transform from the map never waits for a scan."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._settings = settings = node.parameters.follow(read_settings, self._change)
        stored = read_storage_settings(node.parameters)
        self._slam = Slam(settings)
        self._headings = Headings()
        self._correction: Pose2 | None = None
        self._child = settings.odom_frame or settings.base_frame
        self._entropy = node.publish("~entropy", Number, Quality.LATCHED)
        self._output = GridMapOutput(node, settings, self._slam)
        if storage := MapStorage(node, stored, self._output) if stored else None:
            storage.begin(self._slam)
        self._reports = SlamReports(node, self._output.describe, lost=bool(storage and storage.continues))
        node.transforms.ignore((self._child,))
        self._feed = ScanFeed(node, settings.odom_frame, settings.base_frame, self._use_scan, settings.throttle_scans)
        self._lidars = Lidars(node, self._feed, settings.other_scans)
        node.subscribe("imu", Imu, self._on_imu, Quality.EVERY)
        if settings.transform_publish_period > 0.0:
            node.every(settings.transform_publish_period, self._send_transform)

    def _change(self, settings: GmappingSettings) -> None:
        self._settings = settings
        self._output.use(settings)
        self._node.work(lambda: self._slam.use(settings), lambda _done: None, SCANS)

    def _use_scan(self, scan: Scan, odometry: Pose2 | None) -> None:
        readings = self._lidars.readings(scan, odometry)
        if readings:
            self._feed.hold()
            heading = self._headings.at(seconds_of(scan.stamp), odometry) if odometry else None
            self._node.work(lambda: self._slam.step(readings, odometry, heading), self._on_step, SCANS)

    def _on_step(self, step: SlamStep) -> None:
        self._correction = step.correction
        self._reports.on_step(step)
        if step.odometry:
            if not step.estimate.still:
                self._headings.judge(None if step.lost else step.estimate.step, step.estimate.wheels)
            self._reports.watch_gyro(self._headings)
        self._entropy.send(Number(entropy(step.estimate)))
        if step.first:
            self._output.publish()
        self._feed.release()

    def _on_imu(self, imu: Imu) -> None:
        mount = self._feed.find_mount(imu.frame)
        has_rates = imu.turning_variance != -1.0  # sensor_msgs/Imu
        if mount and has_rates:
            self._headings.gyro.add(seconds_of(imu.stamp), float(mount.rotation[2] @ imu.turning))

    def _send_transform(self) -> None:
        """Send the transform from the map at the last scan, which is valid for a while."""
        if self._correction is not None:
            stamp, pose = self._node.now() + round(self._settings.tf_delay * SECOND), self._correction.in_space()
            self._node.transforms.send(Transform(stamp, self._settings.map_frame, self._child, pose))


if __name__ == "__main__":
    sys.exit(run("slam_gmapping", SlamGmappingNode))
