"""Messages of ROS 1 for the values of `ports`, one codec for each kind."""

from __future__ import annotations

import importlib

from ur_nodes.ros1.codecs.codec import Codec, ServiceCodec

__all__ = ["Codec", "ServiceCodec", "find_codec", "find_service"]

# Which module knows a kind: messages take long to import, and a node needs few.
_MODULES = {
    "ur_nodes.ros1.codecs.simple": ("str", "bool", "float", "int", "Number", "Signal", "Time", "ClockTime", "LogLine"),
    "ur_nodes.ros1.codecs.motion": ("Twist", "StampedTwist", "Odometry", "DriverOdometry", "Joints", "Joystick"),
    "ur_nodes.ros1.codecs.places": ("PlacedPose", "PoseEstimate", "Poses", "Path", "Outline"),
    "ur_nodes.ros1.codecs.goals": ("GoalId",),
    "ur_nodes.ros1.codecs.sensors": ("Scan", "Range", "Imu", "Battery"),
    "ur_nodes.ros1.codecs.maps": ("Map", "MapInfo", "MapUpdate"),
    "ur_nodes.ros1.codecs.markers": ("Markers", "MarkerChange", "MarkerChanges"),
    "ur_nodes.ros1.codecs.clouds": ("PointCloud",),
    "ur_nodes.ros1.codecs.pictures": ("Picture", "PackedPicture", "Calibration"),
    "ur_nodes.ros1.codecs.camera_services": ("UseCalibration",),
    "ur_nodes.ros1.codecs.fiducials": ("SeenFiducials", "PlacedFiducials", "MappedFiducials"),
    "ur_nodes.ros1.codecs.frames": ("tuple",),
    "ur_nodes.ros1.codecs.services": ("Trigger", "Silent", "Switch", "AskMap", "UseMap", "AskPath", "Place"),
}
_MODULE_OF = {kind: module for module, kinds in _MODULES.items() for kind in kinds}


def find_codec(kind: type) -> Codec:
    """The codec of a kind of value. Raises KeyError: no message is known for it."""
    codec: Codec = importlib.import_module(_MODULE_OF[kind.__name__]).CODECS[kind]
    return codec


def find_service(kind: type) -> ServiceCodec:
    """The codec of a kind of request. Raises KeyError: no service is known for it."""
    codec: ServiceCodec = importlib.import_module(_MODULE_OF[kind.__name__]).SERVICES[kind]
    return codec
