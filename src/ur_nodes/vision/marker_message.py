"""Fiducials as RViz shows them."""

from __future__ import annotations

from collections.abc import Mapping

from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ur_nodes.geometry.rigid import Floats
from ur_nodes.vision.image_message import pose_of


def make_markers(poses: Mapping[int, Floats], sizes: Mapping[int, float], frame: str) -> MarkerArray:
    """A plate and its number for each fiducial; what was shown before is taken away."""
    made = [Marker(action=Marker.DELETEALL)]
    for number, pose in sorted(poses.items()):
        size = sizes[number]
        plate = Marker(ns="fiducials", id=number, type=Marker.CUBE, pose=pose_of(pose))
        plate.scale, plate.color = Vector3(size, size, 0.01), ColorRGBA(0.95, 0.6, 0.1, 1.0)
        text = Marker(ns="numbers", id=number, type=Marker.TEXT_VIEW_FACING, pose=pose_of(pose), text=str(number))
        text.scale, text.color = Vector3(0.0, 0.0, 0.8 * size), ColorRGBA(1.0, 1.0, 1.0, 1.0)
        text.pose.position.z += size
        made += [plate, text]
    for marker in made:
        marker.header.frame_id = frame
    return MarkerArray(made)
