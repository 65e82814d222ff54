"""Made by tools/make_message_stubs.py. Do not edit."""

from typing import ClassVar, TypeAlias
import genpy
import dynamic_reconfigure.msg

class ReconfigureRequest(genpy.Message):
    config: dynamic_reconfigure.msg.Config
    def __init__(self, config: dynamic_reconfigure.msg.Config = ...) -> None: ...

class ReconfigureResponse(genpy.Message):
    config: dynamic_reconfigure.msg.Config
    def __init__(self, config: dynamic_reconfigure.msg.Config = ...) -> None: ...

class Reconfigure:
    _type: ClassVar[str]
    _md5sum: ClassVar[str]
    _request_class: ClassVar[type[ReconfigureRequest]]
    _response_class: ClassVar[type[ReconfigureResponse]]
    Request: TypeAlias = ReconfigureRequest  # of ROS 2, as is the next
    Response: TypeAlias = ReconfigureResponse
