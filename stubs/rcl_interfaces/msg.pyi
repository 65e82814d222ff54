"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
import genpy

class Log(genpy.Message):
    DEBUG: int
    INFO: int
    WARN: int
    ERROR: int
    FATAL: int
    stamp: genpy.Time
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    def __init__(
        self,
        stamp: genpy.Time = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
    ) -> None: ...

class ParameterValue(genpy.Message):
    type: int
    bool_value: bool
    integer_value: int
    double_value: float
    string_value: str
    byte_array_value: Sequence[int]
    bool_array_value: Sequence[bool]
    integer_array_value: Sequence[int]
    double_array_value: Sequence[float]
    string_array_value: Sequence[str]
    def __init__(
        self,
        type: int = ...,
        bool_value: bool = ...,
        integer_value: int = ...,
        double_value: float = ...,
        string_value: str = ...,
        byte_array_value: Sequence[int] = ...,
        bool_array_value: Sequence[bool] = ...,
        integer_array_value: Sequence[int] = ...,
        double_array_value: Sequence[float] = ...,
        string_array_value: Sequence[str] = ...,
    ) -> None: ...
