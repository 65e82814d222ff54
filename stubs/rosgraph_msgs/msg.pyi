"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
import genpy
import std_msgs.msg

class Clock(genpy.Message):
    clock: genpy.Time
    def __init__(self, clock: genpy.Time = ...) -> None: ...

class Log(genpy.Message):
    DEBUG: int
    INFO: int
    WARN: int
    ERROR: int
    FATAL: int
    header: std_msgs.msg.Header
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    topics: Sequence[str]
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
        topics: Sequence[str] = ...,
    ) -> None: ...
