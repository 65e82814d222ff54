"""The outputs of the robot's pose on a map of fiducials: `fiducial_pose`, and the transform from the map."""

from __future__ import annotations

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.values import PoseEstimate, Transform
from ur_nodes.vision.fiducial_slam import FiducialStep, Moment
from ur_nodes.vision.slam_settings import SlamSettings


class PoseOutput:
    """Publishes each step, and the transform repeatedly while the robot's pose is known.

    While it is not known there is no transform, so that a navigator that depends on it stops.
    """

    def __init__(self, node: Node, settings: SlamSettings) -> None:
        self._node, self._settings = node, settings
        self._correction: Pose2 | None = None
        self._pose = node.publish("fiducial_pose", PoseEstimate)
        node.every(settings.interval, self._send_transform)

    def take(self, _moment: Moment, step: FiducialStep) -> None:
        """Log and send a step."""
        for line in step.warnings:
            self._node.log.warn(line)
        if step.found:
            self._node.log.info(step.found)
        self._correction = step.correction
        self._send_transform()
        if step.estimate:
            self._pose.send(step.estimate)

    def forget(self) -> None:
        """Send nothing until the next step: the robot's pose is unknown."""
        self._correction = None

    def _send_transform(self) -> None:
        settings, correction = self._settings, self._correction
        if correction is not None and settings.publish_tf:
            stamp = self._node.now() + round(settings.future * SECOND)
            frames = settings.map_frame, settings.odom_frame
            self._node.transforms.send(Transform(stamp, *frames, correction.in_space()))
