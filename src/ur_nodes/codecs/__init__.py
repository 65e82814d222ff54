"""Messages of ROS 1 and of ROS 2 for the values of `ports`, one codec for each kind."""

import importlib
from typing import TypeVar

from ur_nodes.codecs.codec import Codec, KindCodec, KindServiceCodec, ServiceCodec

Value = TypeVar("Value")

__all__ = ["Codec", "KindCodec", "KindServiceCodec", "ServiceCodec", "find_codec", "find_offered", "find_service"]

_OPTIONAL = "ur_nodes.codecs.nav2.services"

# Which module knows a kind: messages take long to import, and a node needs few.
_MODULES = {
    "ur_nodes.codecs.simple": ("str", "bool", "float", "int", "Number", "Signal", "Time", "ClockTime", "LogLine"),
    "ur_nodes.codecs.motion": ("Twist", "StampedTwist", "Odometry", "DriverOdometry", "Joints", "Joystick"),
    "ur_nodes.codecs.poses": ("StampedPose", "PoseEstimate", "Poses", "Path", "Outline", "AskPath"),
    "ur_nodes.codecs.goals": ("Goal", "GoalId", "GoalState", "GoalStates"),
    "ur_nodes.codecs.sensors": ("Scan", "Range", "Imu", "Battery"),
    "ur_nodes.codecs.maps": ("Map", "MapInfo", "MapUpdate", "AskMap", "UseMap", "Place"),
    "ur_nodes.codecs.vision.markers": ("Markers", "MarkerChange", "MarkerChanges"),
    "ur_nodes.codecs.vision.clouds": ("PointCloud",),
    "ur_nodes.codecs.vision.pictures": ("Picture", "PackedPicture", "Calibration", "UseCalibration"),
    "ur_nodes.codecs.vision.fiducials": ("SeenFiducials", "StampedFiducials", "MappedFiducials"),
    "ur_nodes.codecs.frames": ("tuple",),
    "ur_nodes.codecs.services": ("Trigger", "Silent", "Switch"),
    _OPTIONAL: ("LoadMap", "ClearCostmap"),
}
_MODULE_OF = {kind: module for module, kinds in _MODULES.items() for kind in kinds}


def find_codec(kind: type[Value]) -> KindCodec[Value]:
    """Return the codec of a kind of value. Raises KeyError if no message is known for it."""
    codec: KindCodec[Value] = importlib.import_module(_MODULE_OF[kind.__name__]).CODECS[kind]
    return codec


def find_service(kind: type[Value]) -> KindServiceCodec[Value]:
    """Return the codec of a kind of request. Raises KeyError if no service is known for it."""
    codec: KindServiceCodec[Value] = importlib.import_module(_MODULE_OF[kind.__name__]).SERVICES[kind]
    return codec


def find_offered(kind: type[Value]) -> KindServiceCodec[Value] | None:
    """Return the codec of a kind of request; None for an optional service whose messages are not installed."""
    name = _MODULE_OF[kind.__name__]
    if name == _OPTIONAL and kind not in importlib.import_module(name).SERVICES:
        return None
    return find_service(kind)
