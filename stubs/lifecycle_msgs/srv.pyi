"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy
import lifecycle_msgs.msg

class GetStateRequest(genpy.Message):
    def __init__(self) -> None: ...

class GetStateResponse(genpy.Message):
    current_state: lifecycle_msgs.msg.State
    def __init__(self, current_state: lifecycle_msgs.msg.State = ...) -> None: ...

class GetState:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[GetStateRequest]]
    _response_class: ClassVar[type[GetStateResponse]]
    Request: TypeAlias = GetStateRequest  # of ROS 2, as is the next
    Response: TypeAlias = GetStateResponse
