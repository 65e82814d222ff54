"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy

class Bool(genpy.Message):
    data: bool
    def __init__(self, data: bool = ...) -> None: ...

class ColorRGBA(genpy.Message):
    r: float
    g: float
    b: float
    a: float
    def __init__(self, r: float = ..., g: float = ..., b: float = ..., a: float = ...) -> None: ...

class Empty(genpy.Message):
    def __init__(self) -> None: ...

class Float32(genpy.Message):
    data: float
    def __init__(self, data: float = ...) -> None: ...

class Float64(genpy.Message):
    data: float
    def __init__(self, data: float = ...) -> None: ...

class Header(genpy.Message):
    seq: int
    stamp: genpy.Time
    frame_id: str
    def __init__(self, seq: int = ..., stamp: genpy.Time = ..., frame_id: str = ...) -> None: ...

class Int32(genpy.Message):
    data: int
    def __init__(self, data: int = ...) -> None: ...

class String(genpy.Message):
    data: str
    def __init__(self, data: str = ...) -> None: ...

class Time(genpy.Message):
    data: genpy.Time
    def __init__(self, data: genpy.Time = ...) -> None: ...
