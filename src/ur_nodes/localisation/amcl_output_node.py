"""Outputs of the node `amcl`: pose, particles, tf map -> odom, and the parameters of the initial pose."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped, TransformStamped
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl_settings import AmclSettings, saved_parameters
from ur_nodes.localisation.localiser import Estimate
from ur_nodes.localisation.particle_filter import Particles
from ur_nodes.rosio.geometry import pose_message, transform_message


class Outputs:
    """Publishers of one node. `last` is the newest estimate, None before the first."""

    def __init__(self, settings: AmclSettings) -> None:
        self._settings = settings
        self._pose = rospy.Publisher("amcl_pose", PoseWithCovarianceStamped, queue_size=2, latch=True)
        self._cloud = rospy.Publisher("particlecloud", PoseArray, queue_size=2, latch=True)
        self._broadcaster = tf2_ros.TransformBroadcaster()
        self._correction: Pose2 | None = None
        self._cloud_due = self._save_due = 0.0
        self._saved: Estimate | None = None
        self.last: Estimate | None = None

    def publish_estimate(self, estimate: Estimate, odometry: Pose2, particles: Particles, stamp: rospy.Time) -> None:
        """Publish a new estimate for a stamp at which the odometry was `odometry`."""
        self.last = estimate
        self._correction = estimate.pose.compose(odometry.inverse())
        message = PoseWithCovarianceStamped()
        message.header.frame_id = self._settings.map_frame
        message.header.stamp = stamp
        message.pose.pose = pose_message(estimate.pose)
        for row, place in enumerate((0, 1, 5)):
            for column, other in enumerate((0, 1, 5)):
                message.pose.covariance[6 * place + other] = float(estimate.covariance[row, column])
        self._pose.publish(message)
        now = stamp.to_sec()
        period = 1.0 / self._settings.cloud_rate if self._settings.cloud_rate > 0.0 else 0.0
        if not self._cloud_due - period <= now < self._cloud_due:
            self._cloud_due = now + period
            self._cloud.publish(CloudMessage(self._settings.map_frame, stamp, particles.poses))

    def publish_correction(self, stamp: rospy.Time) -> None:
        """Publish the transform map -> odom of the last estimate, valid until `transform_tolerance` after the stamp."""
        if not self._correction or not self._settings.tf_broadcast:
            return
        message = TransformStamped()
        message.header.frame_id = self._settings.map_frame
        message.header.stamp = stamp + rospy.Duration(self._settings.transform_tolerance)
        message.child_frame_id = self._settings.odom_frame
        message.transform = transform_message(self._correction)
        self._broadcaster.sendTransform(message)

    def save_sometimes(self) -> None:
        """Put the pose where a node that is started again finds it, at most `save_pose_rate` times a second."""
        rate, now = self._settings.save_rate, rospy.get_time()
        if rate <= 0.0 or self.last is self._saved or self.last is None:
            return
        if self._save_due - 1.0 / rate <= now < self._save_due:
            return
        self._save_due, self._saved = now + 1.0 / rate, self.last
        with contextlib.suppress(OSError):  # the master is gone: nobody reads the parameters
            for name, value in saved_parameters(self.last.pose, self.last.covariance).items():
                rospy.set_param(f"~{name}", value)


class CloudMessage(PoseArray):  # type: ignore[misc]  # generated message classes have no types
    """Many poses, written fast: `planar` is float64 (n, 3), m, m, rad; `poses` stays empty. To publish, not to read."""

    __slots__ = ("planar",)

    def __init__(self, frame: str, stamp: Any, planar: NDArray[np.float64]) -> None:
        super().__init__()
        self.header.frame_id = frame
        self.header.stamp = stamp
        self.planar = planar

    def serialize(self, buff: Any) -> None:
        """Write header, number and poses as http://wiki.ros.org/msg describes (little-endian)."""
        self.header.serialize(buff)
        buff.write(np.uint32(len(self.planar)).astype("<u4").tobytes())
        poses = np.zeros((len(self.planar), 7), dtype="<f8")
        poses[:, :2] = self.planar[:, :2]
        poses[:, 5] = np.sin(0.5 * self.planar[:, 2])
        poses[:, 6] = np.cos(0.5 * self.planar[:, 2])
        buff.write(poses.tobytes())
