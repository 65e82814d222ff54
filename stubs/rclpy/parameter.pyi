from typing import Any

class Parameter:
    name: str
    value: Any
    def __init__(self, name: str, *, value: object = ...) -> None: ...
