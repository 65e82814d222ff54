from typing import Any

class Parameter:
    name: str
    value: Any
    type_: Any
    def to_parameter_msg(self) -> Any: ...
    def __init__(self, name: str, *, value: object = ...) -> None: ...
