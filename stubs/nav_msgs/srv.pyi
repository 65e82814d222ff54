"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy
import geometry_msgs.msg
import nav_msgs.msg

class GetMapRequest(genpy.Message):
    def __init__(self) -> None: ...

class GetMapResponse(genpy.Message):
    map: nav_msgs.msg.OccupancyGrid
    def __init__(self, map: nav_msgs.msg.OccupancyGrid = ...) -> None: ...

class GetMap:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[GetMapRequest]]
    _response_class: ClassVar[type[GetMapResponse]]
    Request: TypeAlias = GetMapRequest  # of ROS 2, as is the next
    Response: TypeAlias = GetMapResponse

class GetPlanRequest(genpy.Message):
    start: geometry_msgs.msg.PoseStamped
    goal: geometry_msgs.msg.PoseStamped
    tolerance: float
    def __init__(
        self,
        start: geometry_msgs.msg.PoseStamped = ...,
        goal: geometry_msgs.msg.PoseStamped = ...,
        tolerance: float = ...,
    ) -> None: ...

class GetPlanResponse(genpy.Message):
    plan: nav_msgs.msg.Path
    def __init__(self, plan: nav_msgs.msg.Path = ...) -> None: ...

class GetPlan:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[GetPlanRequest]]
    _response_class: ClassVar[type[GetPlanResponse]]
    Request: TypeAlias = GetPlanRequest  # of ROS 2, as is the next
    Response: TypeAlias = GetPlanResponse

class SetMapRequest(genpy.Message):
    map: nav_msgs.msg.OccupancyGrid
    initial_pose: geometry_msgs.msg.PoseWithCovarianceStamped
    def __init__(
        self, map: nav_msgs.msg.OccupancyGrid = ..., initial_pose: geometry_msgs.msg.PoseWithCovarianceStamped = ...
    ) -> None: ...

class SetMapResponse(genpy.Message):
    success: bool
    def __init__(self, success: bool = ...) -> None: ...

class SetMap:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[SetMapRequest]]
    _response_class: ClassVar[type[SetMapResponse]]
    Request: TypeAlias = SetMapRequest  # of ROS 2, as is the next
    Response: TypeAlias = SetMapResponse
