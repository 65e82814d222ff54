"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
import genpy
import geometry_msgs.msg
import std_msgs.msg

class MapMetaData(genpy.Message):
    map_load_time: genpy.Time
    resolution: float
    width: int
    height: int
    origin: geometry_msgs.msg.Pose
    def __init__(
        self,
        map_load_time: genpy.Time = ...,
        resolution: float = ...,
        width: int = ...,
        height: int = ...,
        origin: geometry_msgs.msg.Pose = ...,
    ) -> None: ...

class OccupancyGrid(genpy.Message):
    header: std_msgs.msg.Header
    info: MapMetaData
    data: Sequence[int]
    def __init__(
        self, header: std_msgs.msg.Header = ..., info: MapMetaData = ..., data: Sequence[int] = ...
    ) -> None: ...

class Odometry(genpy.Message):
    header: std_msgs.msg.Header
    child_frame_id: str
    pose: geometry_msgs.msg.PoseWithCovariance
    twist: geometry_msgs.msg.TwistWithCovariance
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        child_frame_id: str = ...,
        pose: geometry_msgs.msg.PoseWithCovariance = ...,
        twist: geometry_msgs.msg.TwistWithCovariance = ...,
    ) -> None: ...

class Path(genpy.Message):
    header: std_msgs.msg.Header
    poses: list[geometry_msgs.msg.PoseStamped]
    def __init__(self, header: std_msgs.msg.Header = ..., poses: list[geometry_msgs.msg.PoseStamped] = ...) -> None: ...
