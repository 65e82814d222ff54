"""Builds a map of fiducials, or finds the robot on one: the node fiducial_slam, with its topics and parameters.

It takes the corners of fiducials (`fiducial_vertices`) rather than their poses (`fiducial_transforms`): only corners
tell how sure a pose is, and that a second one explains them as well.
"""

from __future__ import annotations

import sys

from ur_nodes.ports.fiducials import SeenFiducials
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Calibration
from ur_nodes.run import run
from ur_nodes.vision.detect import CameraModel, camera_model
from ur_nodes.vision.fiducial_parameters import read_sizes
from ur_nodes.vision.fiducial_slam import Moment
from ur_nodes.vision.map_output import FiducialMapOutput
from ur_nodes.vision.pose_output import PoseOutput
from ur_nodes.vision.requests import MAP, FiducialMapRequests
from ur_nodes.vision.slam_settings import make_slam, read_slam_settings


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
        self._work = NewestWork(node, MAP, slam.step, output.take)
        node.transforms.ignore((settings.odom_frame,))
        node.transforms.watch(self._try)
        node.subscribe("camera_info", Calibration, self._take_calibration)
        node.subscribe("fiducial_vertices", SeenFiducials, self._take)
        FiducialMapRequests(node, settings, slam, output.forget)
        FiducialMapOutput(node, settings, sizes, slam)

    def _take_calibration(self, calibration: Calibration) -> None:
        self._camera = camera_model(calibration)

    def _take(self, seen: SeenFiducials) -> None:
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
