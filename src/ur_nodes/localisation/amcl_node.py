"""The node `amcl`: localisation on a known map, from odometry and a lidar."""

import sys
from collections.abc import Callable

from ur_nodes.calibration_reports import CalibrationReports
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl import Amcl
from ur_nodes.localisation.amcl_settings import AmclSettings, read_settings, saved_parameters
from ur_nodes.localisation.localiser import ClusterEstimate
from ur_nodes.localisation.particle_filter import Particles
from ur_nodes.memory_use import return_large_arrays
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import SILENCE, ScanFeed
from ur_nodes.ports.services import AskMap, Silent, UseMap
from ur_nodes.ports.values import Map, PoseEstimate, Poses, Result, Scan, Transform
from ur_nodes.run import run

_PATIENCE = 120.0  # s: large maps take long over WiFi


class MapSource:
    """Passes on each map of the topic `map`, or that of the service `static_map` once it is available."""

    def __init__(self, node: Node, callback: Callable[[Map], None], *, topic: bool) -> None:
        self._node, self._take = node, callback
        self._asking = False
        if topic:
            node.subscribe("map", Map, callback, Quality.LATCHED)
        else:
            self._timer = node.every(1.0, self._ask)
            self._ask()

    def _ask(self) -> None:
        if not self._asking:
            self._asking = True
            self._node.call("static_map", AskMap(), self._on_answer, _PATIENCE)

    def _on_answer(self, answer: Result) -> None:
        self._asking = False
        if isinstance(answer.value, Map):
            self._timer.cancel()
            self._take(answer.value)
        else:
            service = self._node.resolve("static_map")
            self._node.log.warn(f"no map from service {service} yet: {answer.text}", every=SILENCE)


class AmclOutputs:
    """Publishers of one node."""

    def __init__(self, node: Node, settings: AmclSettings) -> None:
        self._node = node
        self._settings = settings
        self._pose = node.publish("amcl_pose", PoseEstimate, Quality.LATCHED)
        self._cloud = node.publish("particlecloud", Poses, Quality.LATCHED)
        self._lost = node.publish("~lost", str, Quality.LATCHED)
        self._lost.send("")
        self._lost_text = ""
        self._cloud_due = self._save_due = 0.0
        self._last: ClusterEstimate | None = None
        self._saved: ClusterEstimate | None = None

    def publish_estimate(self, estimate: ClusterEstimate, particles: Particles, stamp: int) -> None:
        """Publish a new estimate for a time (ns)."""
        self._last = estimate
        frame = self._settings.map_frame
        self._pose.send(PoseEstimate(stamp, frame, estimate.pose, estimate.covariance))
        now = stamp / SECOND
        period = 1.0 / self._settings.cloud_rate if self._settings.cloud_rate > 0.0 else 0.0
        if not self._cloud_due - period <= now < self._cloud_due:
            self._cloud_due = now + period
            self._cloud.send(Poses(stamp, frame, particles.poses))

    def publish_lost(self, text: str) -> None:
        """Publish that the robot is lost, with a description of the search; '' once it is found."""
        if text != self._lost_text:
            self._lost_text = text
            self._lost.send(text)

    def publish_correction(self, correction: Pose2, stamp: int) -> None:
        """Publish the transform map -> odom of the last estimate, valid until `transform_tolerance` after the stamp."""
        settings = self._settings
        if settings.tf_broadcast:
            valid = stamp + round(settings.transform_tolerance * SECOND)
            transform = Transform(valid, settings.map_frame, settings.odom_frame, correction.in_space())
            self._node.transforms.send(transform)

    def save_sometimes(self) -> None:
        """Save the pose for a restarted node, at most `save_pose_rate` times a second."""
        rate, now, last = self._settings.save_rate, self._node.now() / SECOND, self._last
        if rate <= 0.0 or last is None or last is self._saved or self._save_due - 1.0 / rate <= now < self._save_due:
            return
        self._save_due, self._saved = now + 1.0 / rate, last
        values = saved_parameters(last.pose, last.covariance)
        self._node.work(lambda: self._node.parameters.keep_all(values), lambda _done: None)


class AmclNode:
    """Connects an `Amcl` to topics."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._settings = settings = node.parameters.follow(read_settings, lambda changed: self._amcl.use(changed))
        self._amcl = Amcl(settings, node.log)
        self._outputs = AmclOutputs(node, settings)
        self._reports = CalibrationReports(node)
        node.transforms.ignore((settings.odom_frame,))
        self._feed = ScanFeed(node, settings.odom_frame, settings.base_frame, self._use_scan)
        node.subscribe("initialpose", PoseEstimate, self._place, Quality.EVERY)
        node.serve("global_localization", Silent, lambda _request: self._amcl.scatter())
        node.serve("request_nomotion_update", Silent, lambda _request: self._amcl.request_update())
        node.serve("set_map", UseMap, self._set_map)
        self._source = MapSource(node, self._on_map, topic=settings.use_map_topic)

    def _on_map(self, given: Map) -> None:
        if not (self._settings.first_map_only and self._amcl.has_map):
            self._amcl.use_map(given)

    def _set_map(self, request: UseMap) -> Result:
        self._amcl.use_map(request.map)
        self._place(PoseEstimate(request.stamp, request.frame, request.pose, request.covariance))
        return Result(success=True)

    def _place(self, given: PoseEstimate) -> None:
        before, now = self._feed.odometry(given.stamp), self._feed.odometry()
        known = given.stamp and before and now  # else the odometry does not reach back so far
        moved = before.inverse().compose(now) if known and before and now else Pose2(0.0, 0.0, 0.0)
        self._amcl.set_pose(given, moved)

    def _use_scan(self, scan: Scan, odometry: Pose2 | None) -> None:
        mount = self._feed.mount(scan.frame)
        if mount and odometry and self._amcl.has_map:
            estimate = self._amcl.update(scan, mount, odometry)
            self._outputs.publish_lost(self._amcl.lost)
            if estimate:
                self._outputs.publish_estimate(estimate, self._amcl.particles, scan.stamp)
                self._reports.figures = self._amcl.calibration.figures(mount.planar())
            if self._amcl.correction:
                self._outputs.publish_correction(self._amcl.correction, scan.stamp)
            self._outputs.save_sometimes()


def main() -> int:
    """Run until shutdown; exit code 2 when a parameter cannot be used."""
    return_large_arrays()
    return run("amcl", AmclNode)


if __name__ == "__main__":
    sys.exit(main())
