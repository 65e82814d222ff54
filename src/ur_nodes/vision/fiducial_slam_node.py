"""Builds a map of fiducials, or finds the robot on one: the node fiducial_slam, with its topics and parameters.

It takes the corners of fiducials (`fiducial_vertices`) rather than their poses (`fiducial_transforms`): only corners
tell how sure a pose is, and that a second one explains them as well.
"""

import sys

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.fiducials import SeenFiducials
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.values import Calibration, PoseEstimate, Transform
from ur_nodes.run import run
from ur_nodes.vision.detect import CameraModel, camera_model
from ur_nodes.vision.fiducial_detect import MAP, FiducialMapRequests
from ur_nodes.vision.fiducial_parameters import SlamSettings, make_slam, read_sizes, read_slam_settings
from ur_nodes.vision.fiducial_slam import FiducialStep, Moment
from ur_nodes.vision.map_output import FiducialMapOutput


class PoseOutput:
    """Publishes each step, and the transform repeatedly while the robot's pose is known.

    While it is not known there is no transform, so that a navigator that depends on it stops.
    """

    def __init__(self, node: Node, settings: SlamSettings) -> None:
        self._node, self._settings = node, settings
        self._correction: Pose2 | None = None
        self._pose = node.publish("fiducial_pose", PoseEstimate)
        node.every(settings.interval, self._send_transform)

    def on_step(self, _moment: Moment, step: FiducialStep) -> None:
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


class FiducialSlamNode:
    """Takes each set of corners when the frames at its time are known, newest first."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._settings = settings = read_slam_settings(node.parameters)
        sizes = read_sizes(node.parameters)
        slam = make_slam(node.parameters, settings, sizes)
        self._camera: CameraModel | None = None
        self._waiting: SeenFiducials | None = None
        output = PoseOutput(node, settings)
        self._work = NewestWork(node, MAP, slam.step, output.on_step)
        node.transforms.ignore((settings.odom_frame,))
        node.transforms.watch(self._try)
        node.subscribe("camera_info", Calibration, self._on_calibration)
        node.subscribe("fiducial_vertices", SeenFiducials, self._on_fiducials)
        FiducialMapRequests(node, settings, slam, output.forget)
        FiducialMapOutput(node, settings, sizes, slam)

    def _on_calibration(self, calibration: Calibration) -> None:
        self._camera = camera_model(calibration)

    def _on_fiducials(self, seen: SeenFiducials) -> None:
        self._waiting = seen
        self._try()

    def _try(self) -> None:
        """Use the last corners if the frames at their time are known by now."""
        seen, camera, settings, frames = self._waiting, self._camera, self._settings, self._node.transforms
        if seen is None or camera is None:
            return
        odometry = frames.find_planar(settings.odom_frame, settings.base_frame, seen.stamp)
        mount = frames.find(settings.base_frame, seen.frame)
        if odometry is not None and mount is not None:
            self._waiting = None
            self._work.ask(Moment(seen, camera, mount, odometry))


if __name__ == "__main__":
    sys.exit(run("fiducial_slam", FiducialSlamNode))
