"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import MutableSequence
import genpy
import std_msgs.msg

class Point(genpy.Message):
    x: float
    y: float
    z: float
    def __init__(self, x: float = ..., y: float = ..., z: float = ...) -> None: ...

class Point32(genpy.Message):
    x: float
    y: float
    z: float
    def __init__(self, x: float = ..., y: float = ..., z: float = ...) -> None: ...

class Polygon(genpy.Message):
    points: list[Point32]
    def __init__(self, points: list[Point32] = ...) -> None: ...

class PolygonStamped(genpy.Message):
    header: std_msgs.msg.Header
    polygon: Polygon
    def __init__(self, header: std_msgs.msg.Header = ..., polygon: Polygon = ...) -> None: ...

class Pose(genpy.Message):
    position: Point
    orientation: Quaternion
    def __init__(self, position: Point = ..., orientation: Quaternion = ...) -> None: ...

class PoseArray(genpy.Message):
    header: std_msgs.msg.Header
    poses: list[Pose]
    def __init__(self, header: std_msgs.msg.Header = ..., poses: list[Pose] = ...) -> None: ...

class PoseStamped(genpy.Message):
    header: std_msgs.msg.Header
    pose: Pose
    def __init__(self, header: std_msgs.msg.Header = ..., pose: Pose = ...) -> None: ...

class PoseWithCovariance(genpy.Message):
    pose: Pose
    covariance: MutableSequence[float]
    def __init__(self, pose: Pose = ..., covariance: MutableSequence[float] = ...) -> None: ...

class PoseWithCovarianceStamped(genpy.Message):
    header: std_msgs.msg.Header
    pose: PoseWithCovariance
    def __init__(self, header: std_msgs.msg.Header = ..., pose: PoseWithCovariance = ...) -> None: ...

class Quaternion(genpy.Message):
    x: float
    y: float
    z: float
    w: float
    def __init__(self, x: float = ..., y: float = ..., z: float = ..., w: float = ...) -> None: ...

class Transform(genpy.Message):
    translation: Vector3
    rotation: Quaternion
    def __init__(self, translation: Vector3 = ..., rotation: Quaternion = ...) -> None: ...

class TransformStamped(genpy.Message):
    header: std_msgs.msg.Header
    child_frame_id: str
    transform: Transform
    def __init__(
        self, header: std_msgs.msg.Header = ..., child_frame_id: str = ..., transform: Transform = ...
    ) -> None: ...

class Twist(genpy.Message):
    linear: Vector3
    angular: Vector3
    def __init__(self, linear: Vector3 = ..., angular: Vector3 = ...) -> None: ...

class TwistStamped(genpy.Message):
    header: std_msgs.msg.Header
    twist: Twist
    def __init__(self, header: std_msgs.msg.Header = ..., twist: Twist = ...) -> None: ...

class TwistWithCovariance(genpy.Message):
    twist: Twist
    covariance: MutableSequence[float]
    def __init__(self, twist: Twist = ..., covariance: MutableSequence[float] = ...) -> None: ...

class Vector3(genpy.Message):
    x: float
    y: float
    z: float
    def __init__(self, x: float = ..., y: float = ..., z: float = ...) -> None: ...
