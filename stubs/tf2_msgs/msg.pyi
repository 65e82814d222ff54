"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import geometry_msgs.msg

class TFMessage(genpy.Message):
    transforms: list[geometry_msgs.msg.TransformStamped]
    def __init__(self, transforms: list[geometry_msgs.msg.TransformStamped] = ...) -> None: ...
