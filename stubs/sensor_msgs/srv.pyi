"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy
import sensor_msgs.msg

class SetCameraInfoRequest(genpy.Message):
    camera_info: sensor_msgs.msg.CameraInfo
    def __init__(self, camera_info: sensor_msgs.msg.CameraInfo = ...) -> None: ...

class SetCameraInfoResponse(genpy.Message):
    success: bool
    status_message: str
    def __init__(self, success: bool = ..., status_message: str = ...) -> None: ...

class SetCameraInfo:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[SetCameraInfoRequest]]
    _response_class: ClassVar[type[SetCameraInfoResponse]]
    Request: TypeAlias = SetCameraInfoRequest  # of ROS 2, as is the next
    Response: TypeAlias = SetCameraInfoResponse
