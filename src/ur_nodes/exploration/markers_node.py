"""Frontiers as markers, as upstream's `explore_lite` shows them: blue ones are left, red ones given up or left out."""

from __future__ import annotations

from collections.abc import Sequence

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier

_LEFT, _GIVEN_UP = ColorRGBA(0.0, 0.0, 1.0, 1.0), ColorRGBA(1.0, 0.0, 0.0, 1.0)


def marker_array(frame: str, floor: Floor, frontiers: Sequence[Frontier], blocked: Sequence[Frontier]) -> MarkerArray:
    """All frontiers as points; those of the message before are deleted."""
    markers = [Marker(action=Marker.DELETEALL)]
    for number, (each, colour) in enumerate([(f, _LEFT) for f in frontiers] + [(f, _GIVEN_UP) for f in blocked]):
        marker = Marker(ns="frontiers", id=number, type=Marker.POINTS, action=Marker.ADD, color=colour)
        marker.header.frame_id, marker.header.stamp = frame, rospy.Time.now()
        marker.pose.orientation.w = 1.0
        marker.scale.x = marker.scale.y = 0.1
        marker.points = [Point(float(x), float(y), 0.0) for x, y in floor.points_of_cells(each.cells)]
        markers.append(marker)
    markers[0].header.frame_id = frame
    return MarkerArray(markers)
