"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
from typing import ClassVar, TypeAlias
import genpy
import rcl_interfaces.msg

class GetParametersRequest(genpy.Message):
    names: Sequence[str]
    def __init__(self, names: Sequence[str] = ...) -> None: ...

class GetParametersResponse(genpy.Message):
    values: list[rcl_interfaces.msg.ParameterValue]
    def __init__(self, values: list[rcl_interfaces.msg.ParameterValue] = ...) -> None: ...

class GetParameters:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[GetParametersRequest]]
    _response_class: ClassVar[type[GetParametersResponse]]
    Request: TypeAlias = GetParametersRequest  # of ROS 2, as is the next
    Response: TypeAlias = GetParametersResponse
