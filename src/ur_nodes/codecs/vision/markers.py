"""Shapes as RViz shows them."""

import numpy as np
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker as MarkerMessage
from visualization_msgs.msg import MarkerArray

from ur_nodes.codecs.codec import Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import duration_of, seconds_of, stamp_of
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.values import Marker, MarkerChange, MarkerChanges, Markers, Shape
from ur_nodes.ports.values.shapes import MarkerAction

_SHAPES: dict[Shape, int] = {
    "arrow": MarkerMessage.ARROW,
    "cube": MarkerMessage.CUBE,
    "sphere": MarkerMessage.SPHERE,
    "cylinder": MarkerMessage.CYLINDER,
    "line_strip": MarkerMessage.LINE_STRIP,
    "line_list": MarkerMessage.LINE_LIST,
    "cube_list": MarkerMessage.CUBE_LIST,
    "sphere_list": MarkerMessage.SPHERE_LIST,
    "points": MarkerMessage.POINTS,
    "text": MarkerMessage.TEXT_VIEW_FACING,
    "triangles": MarkerMessage.TRIANGLE_LIST,
}
_SHAPE_OF: dict[int, Shape] = {number: shape for shape, number in _SHAPES.items()}
_ACTIONS: dict[MarkerAction, int] = {
    "put": MarkerMessage.ADD,
    "delete": MarkerMessage.DELETE,
    "clear": MarkerMessage.DELETEALL,
}
_ACTION_OF: dict[int, MarkerAction] = {number: action for action, number in _ACTIONS.items()}


def _fill_markers(message: MarkerArray, value: Markers) -> None:
    delete = MarkerMessage(action=MarkerMessage.DELETEALL)
    fill_header(delete, value.stamp, value.frame)
    message.markers = [delete, *(_message(each, value.stamp, value.frame) for each in value.markers)]


def _message(marker: Marker, stamp: int, frame: str) -> MarkerMessage:
    made = MarkerMessage()
    _fill_marker(made, marker, stamp, frame)
    return made


def _fill_marker(made: MarkerMessage, marker: Marker, stamp: int, frame: str) -> None:
    fill_header(made, stamp, frame)
    made.ns, made.id, made.type, made.text = marker.namespace, marker.number, _SHAPES[marker.shape], marker.text
    place, turn, pose = made.pose.position, made.pose.orientation, marker.pose
    place.x, place.y, place.z = pose.x, pose.y, pose.z
    turn.x, turn.y, turn.z, turn.w = pose.rotation
    made.scale.x, made.scale.y, made.scale.z = marker.size
    made.color.r, made.color.g, made.color.b, made.color.a = marker.colour
    made.points = [Point(x=x, y=y, z=z) for x, y, z in marker.points.tolist()]
    made.colors = [ColorRGBA(r=r, g=g, b=b, a=a) for r, g, b, a in marker.colours.tolist()]


def _markers_of(message: MarkerArray) -> Markers:
    shown = [each for each in message.markers if each.action == MarkerMessage.ADD and each.type in _SHAPE_OF]
    heads = shown or message.markers
    stamp, frame = (stamp_of(heads[0].header.stamp), frame_of(heads[0])) if heads else (0, "")
    return Markers(stamp, frame, tuple(map(_marker_of, shown)))


def _marker_of(message: MarkerMessage) -> Marker:
    place, turn, scale, colour = message.pose.position, message.pose.orientation, message.scale, message.color
    return Marker(
        message.ns,
        message.id,
        _SHAPE_OF.get(message.type, "cube"),
        Pose3(place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w),
        (scale.x, scale.y, scale.z),
        (colour.r, colour.g, colour.b, colour.a),
        message.text,
        np.array([(p.x, p.y, p.z) for p in message.points], dtype=np.float64).reshape(-1, 3),
        np.array([(c.r, c.g, c.b, c.a) for c in message.colors], dtype=np.float64).reshape(-1, 4),
    )


def _fill_change(message: MarkerMessage, value: MarkerChange) -> None:
    _fill_marker(message, value.marker, value.stamp, value.frame)
    message.action = _ACTIONS[value.action]
    message.lifetime = duration_of(value.lifetime)


def _is_known(message: MarkerMessage) -> bool:
    """Return whether a message asks for something that is known; to delete a marker, its shape does not count."""
    return message.action in _ACTION_OF and (message.action != MarkerMessage.ADD or message.type in _SHAPE_OF)


def _change_of(message: MarkerMessage) -> MarkerChange:
    if not _is_known(message):
        raise ValueError(f"marker of type {message.type} with action {message.action}, expected known ones")
    action, life = _ACTION_OF[message.action], seconds_of(message.lifetime)
    return MarkerChange(stamp_of(message.header.stamp), frame_of(message), action, _marker_of(message), life)


def _fill_changes(message: MarkerArray, value: MarkerChanges) -> None:
    message.markers = [MarkerMessage() for _ in value.changes]
    for each, change in zip(message.markers, value.changes, strict=True):
        _fill_change(each, change)


def _changes_of(message: MarkerArray) -> MarkerChanges:
    return MarkerChanges(tuple(_change_of(each) for each in message.markers if _is_known(each)))


CODECS = {
    Markers: Codec(MarkerArray, _fill_markers, _markers_of),
    MarkerChange: Codec(MarkerMessage, _fill_change, _change_of),
    MarkerChanges: Codec(MarkerArray, _fill_changes, _changes_of),
}
