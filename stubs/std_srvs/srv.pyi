"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy

class EmptyRequest(genpy.Message):
    def __init__(self) -> None: ...

class EmptyResponse(genpy.Message):
    def __init__(self) -> None: ...

class Empty:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[EmptyRequest]]
    _response_class: ClassVar[type[EmptyResponse]]
    Request: TypeAlias = EmptyRequest  # of ROS 2, as is the next
    Response: TypeAlias = EmptyResponse

class SetBoolRequest(genpy.Message):
    data: bool
    def __init__(self, data: bool = ...) -> None: ...

class SetBoolResponse(genpy.Message):
    success: bool
    message: str
    def __init__(self, success: bool = ..., message: str = ...) -> None: ...

class SetBool:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[SetBoolRequest]]
    _response_class: ClassVar[type[SetBoolResponse]]
    Request: TypeAlias = SetBoolRequest  # of ROS 2, as is the next
    Response: TypeAlias = SetBoolResponse

class TriggerRequest(genpy.Message):
    def __init__(self) -> None: ...

class TriggerResponse(genpy.Message):
    success: bool
    message: str
    def __init__(self, success: bool = ..., message: str = ...) -> None: ...

class Trigger:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[TriggerRequest]]
    _response_class: ClassVar[type[TriggerResponse]]
    Request: TypeAlias = TriggerRequest  # of ROS 2, as is the next
    Response: TypeAlias = TriggerResponse
