"""The values that nodes exchange. Frames and units are those of REP 103 and 105; stamps are ns of the nodes' clock.

Simple ones travel as Python's own: str, bool, float, int. Arrays are not to be written to: a value may be shared by
all who receive it.
"""

from ur_nodes.ports.values.basics import NO_MATRIX, ClockTime, Level, LogLine, Number, Result, Signal, Time
from ur_nodes.ports.values.motion import DriverOdometry, Joints, Joystick, Odometry, StampedTwist, Twist
from ur_nodes.ports.values.poses import (
    Map,
    MapInfo,
    MapUpdate,
    Outline,
    Path,
    PoseEstimate,
    Poses,
    StampedPose,
    Transform,
)
from ur_nodes.ports.values.sensors import Battery, Calibration, Imu, PackedPicture, Picture, Range, Scan
from ur_nodes.ports.values.shapes import Marker, MarkerChange, MarkerChanges, Markers, PointCloud, Shape

__all__ = [
    "NO_MATRIX",
    "Battery",
    "Calibration",
    "ClockTime",
    "DriverOdometry",
    "Imu",
    "Joints",
    "Joystick",
    "Level",
    "LogLine",
    "Map",
    "MapInfo",
    "MapUpdate",
    "Marker",
    "MarkerChange",
    "MarkerChanges",
    "Markers",
    "Number",
    "Odometry",
    "Outline",
    "PackedPicture",
    "Path",
    "Picture",
    "StampedPose",
    "PointCloud",
    "PoseEstimate",
    "Poses",
    "Range",
    "Result",
    "Scan",
    "Shape",
    "Signal",
    "StampedTwist",
    "Time",
    "Transform",
    "Twist",
]
