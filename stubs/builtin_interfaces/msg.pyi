"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy

class Duration(genpy.Message):
    sec: int
    nanosec: int
    def __init__(self, sec: int = ..., nanosec: int = ...) -> None: ...

class Time(genpy.Message):
    sec: int
    nanosec: int
    def __init__(self, sec: int = ..., nanosec: int = ...) -> None: ...
