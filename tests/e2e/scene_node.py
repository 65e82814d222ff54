"""Publishes what a 3D view and a table of diagnostics show, among it what is hostile, until it is interrupted."""

from __future__ import annotations

import struct
from typing import Any

import rospy
from geometry_msgs.msg import Point
from sensor_msgs.msg import PointCloud2, PointField
from visualization_msgs.msg import Marker, MarkerArray

from ur_nodes.codecs.vision.fiducial_messages import make_classes

DIAGNOSTICS = {
    "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id",
    "KeyValue": "string key\nstring value",
    "DiagnosticStatus": "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n"
    "string name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values",
    "DiagnosticArray": "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status",
}


def make_cloud() -> PointCloud2:
    points = [(0.05 * (n % 60), 0.05 * (n // 60), 0.4 if n % 7 else float("nan")) for n in range(3600)]
    fields = [PointField(name, 4 * at, PointField.FLOAT32, 1) for at, name in enumerate("xyz")]
    fields.append(PointField("rgb", 12, PointField.UINT32, 1))
    data = b"".join(struct.pack("<fffI", *point, 0x20A0FF if n % 2 else 0xFF8000) for n, point in enumerate(points))
    cloud = PointCloud2(height=1, width=3600, fields=fields, point_step=16, row_step=57600, data=data)
    cloud.header.frame_id = "odom"
    return cloud


def make_markers() -> MarkerArray:
    found = []
    for number, kind in enumerate((Marker.ARROW, Marker.CUBE, Marker.SPHERE, Marker.CYLINDER, Marker.TEXT_VIEW_FACING)):
        marker = Marker(ns="<b>", id=number, type=kind, text="a <b>text</b>")
        marker.header.frame_id = "map"
        marker.pose.position.x, marker.pose.position.z, marker.pose.orientation.w = 0.5 * number, 0.8, 1.0
        marker.scale.x = marker.scale.y = marker.scale.z = 0.3
        marker.color.r, marker.color.b, marker.color.a = 0.9, 0.2 * number, 1.0
        found.append(marker)
    line = Marker(ns="line", type=Marker.LINE_STRIP, points=[Point(0.3 * n, 0.3 * (n % 2), 0.2) for n in range(9)])
    line.header.frame_id, line.pose.orientation.w, line.color.g, line.color.a = "map", 1.0, 0.8, 1.0
    bad = Marker(ns="bad", type=Marker.CUBE)
    bad.pose.position.x = float("nan")
    return MarkerArray([*found, line, bad])


def main() -> None:
    rospy.init_node("scene")
    types: dict[str, Any] = make_classes("diagnostic_msgs", DIAGNOSTICS)
    status, value, array = types["DiagnosticStatus"], types["KeyValue"], types["DiagnosticArray"]
    clouds = rospy.Publisher("cloud", PointCloud2, queue_size=1)
    markers = rospy.Publisher("markers", MarkerArray, queue_size=1)
    states = rospy.Publisher("diagnostics", array, queue_size=1)
    while not rospy.is_shutdown():
        clouds.publish(make_cloud())
        markers.publish(make_markers())
        components = [
            status(level=0, name="motors", message="fine", values=[value(key="current", value="0.3 A")]),
            status(level=2, name="lidar <img src=x>", message="no\x1b[2J word"),
            status(level=77, name="strange"),
        ]
        states.publish(array(status=components))
        try:
            rospy.sleep(0.5)
        except rospy.ROSInterruptException:
            return


if __name__ == "__main__":
    main()
