"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import Sequence
import genpy

class FloatingPointRange(genpy.Message):
    from_value: float
    to_value: float
    step: float
    def __init__(self, from_value: float = ..., to_value: float = ..., step: float = ...) -> None: ...

class IntegerRange(genpy.Message):
    from_value: int
    to_value: int
    step: int
    def __init__(self, from_value: int = ..., to_value: int = ..., step: int = ...) -> None: ...

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

class Parameter(genpy.Message):
    name: str
    value: ParameterValue
    def __init__(self, name: str = ..., value: ParameterValue = ...) -> None: ...

class ParameterDescriptor(genpy.Message):
    name: str
    type: int
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: list[FloatingPointRange]
    integer_range: list[IntegerRange]
    def __init__(
        self,
        name: str = ...,
        type: int = ...,
        description: str = ...,
        additional_constraints: str = ...,
        read_only: bool = ...,
        dynamic_typing: bool = ...,
        floating_point_range: list[FloatingPointRange] = ...,
        integer_range: list[IntegerRange] = ...,
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

class SetParametersResult(genpy.Message):
    successful: bool
    reason: str
    def __init__(self, successful: bool = ..., reason: str = ...) -> None: ...
