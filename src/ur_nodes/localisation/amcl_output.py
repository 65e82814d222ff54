"""Outputs of the node `amcl`: pose, particles, tf map -> odom, and the parameters of the initial pose."""

from __future__ import annotations

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl_settings import AmclSettings, saved_parameters
from ur_nodes.localisation.localiser import ClusterEstimate
from ur_nodes.localisation.particle_filter import Particles
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import PoseEstimate, Poses, Transform


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
