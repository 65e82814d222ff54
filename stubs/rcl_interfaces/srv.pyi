"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
from typing import ClassVar, TypeAlias
import genpy
import rcl_interfaces.msg

class DescribeParametersRequest(genpy.Message):
    names: Sequence[str]
    def __init__(self, names: Sequence[str] = ...) -> None: ...

class DescribeParametersResponse(genpy.Message):
    descriptors: list[rcl_interfaces.msg.ParameterDescriptor]
    def __init__(self, descriptors: list[rcl_interfaces.msg.ParameterDescriptor] = ...) -> None: ...

class DescribeParameters:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[DescribeParametersRequest]]
    _response_class: ClassVar[type[DescribeParametersResponse]]
    Request: TypeAlias = DescribeParametersRequest  # of ROS 2, as is the next
    Response: TypeAlias = DescribeParametersResponse

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

class SetParametersRequest(genpy.Message):
    parameters: list[rcl_interfaces.msg.Parameter]
    def __init__(self, parameters: list[rcl_interfaces.msg.Parameter] = ...) -> None: ...

class SetParametersResponse(genpy.Message):
    results: list[rcl_interfaces.msg.SetParametersResult]
    def __init__(self, results: list[rcl_interfaces.msg.SetParametersResult] = ...) -> None: ...

class SetParameters:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[SetParametersRequest]]
    _response_class: ClassVar[type[SetParametersResponse]]
    Request: TypeAlias = SetParametersRequest  # of ROS 2, as is the next
    Response: TypeAlias = SetParametersResponse
