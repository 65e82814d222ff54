"""Shapes as RViz shows them."""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker as MarkerMessage
from visualization_msgs.msg import MarkerArray

from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.values import Marker, Markers
from ur_nodes.ros1.codecs.codec import Codec, fill_header, frame_of, stamp_of

_SHAPES: dict[str, int] = {
    "cube": MarkerMessage.CUBE,
    "text": MarkerMessage.TEXT_VIEW_FACING,
    "points": MarkerMessage.POINTS,
}
_SHAPE_OF: dict[int, Any] = {number: shape for shape, number in _SHAPES.items()}


def _fill_markers(message: Any, value: Markers) -> None:
    delete = MarkerMessage(action=MarkerMessage.DELETEALL)
    fill_header(delete, value.stamp, value.frame)
    message.markers = [delete, *(_message(each, value) for each in value.markers)]


def _message(marker: Marker, value: Markers) -> Any:
    made = MarkerMessage(ns=marker.namespace, id=marker.number, type=_SHAPES[marker.shape], text=marker.text)
    fill_header(made, value.stamp, value.frame)
    place, turn, pose = made.pose.position, made.pose.orientation, marker.pose
    place.x, place.y, place.z = pose.x, pose.y, pose.z
    turn.x, turn.y, turn.z, turn.w = pose.rotation
    made.scale.x, made.scale.y, made.scale.z = marker.size
    made.color.r, made.color.g, made.color.b, made.color.a = marker.colour
    made.points = [Point(*each) for each in marker.points.tolist()]
    return made


def _markers_of(message: Any) -> Markers:
    shown = [each for each in message.markers if each.action == MarkerMessage.ADD and each.type in _SHAPE_OF]
    head = message.markers[0] if message.markers else None
    stamp, frame = (stamp_of(head.header.stamp), frame_of(head)) if head is not None else (0, "")
    return Markers(stamp, frame, tuple(map(_marker_of, shown)))


def _marker_of(message: Any) -> Marker:
    place, turn, scale, colour = message.pose.position, message.pose.orientation, message.scale, message.color
    return Marker(
        message.ns,
        message.id,
        _SHAPE_OF[message.type],
        Pose3(place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w),
        (scale.x, scale.y, scale.z),
        (colour.r, colour.g, colour.b, colour.a),
        message.text,
        np.array([(p.x, p.y, p.z) for p in message.points], dtype=np.float64).reshape(-1, 3),
    )


CODECS = {Markers: Codec(MarkerArray, _fill_markers, _markers_of)}
