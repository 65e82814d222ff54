"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy

class BoolParameter(genpy.Message):
    name: str
    value: bool
    def __init__(self, name: str = ..., value: bool = ...) -> None: ...

class Config(genpy.Message):
    bools: list[BoolParameter]
    ints: list[IntParameter]
    strs: list[StrParameter]
    doubles: list[DoubleParameter]
    groups: list[GroupState]
    def __init__(
        self,
        bools: list[BoolParameter] = ...,
        ints: list[IntParameter] = ...,
        strs: list[StrParameter] = ...,
        doubles: list[DoubleParameter] = ...,
        groups: list[GroupState] = ...,
    ) -> None: ...

class ConfigDescription(genpy.Message):
    groups: list[Group]
    max: Config
    min: Config
    dflt: Config
    def __init__(self, groups: list[Group] = ..., max: Config = ..., min: Config = ..., dflt: Config = ...) -> None: ...

class DoubleParameter(genpy.Message):
    name: str
    value: float
    def __init__(self, name: str = ..., value: float = ...) -> None: ...

class Group(genpy.Message):
    name: str
    type: str
    parameters: list[ParamDescription]
    parent: int
    id: int
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        parameters: list[ParamDescription] = ...,
        parent: int = ...,
        id: int = ...,
    ) -> None: ...

class GroupState(genpy.Message):
    name: str
    state: bool
    id: int
    parent: int
    def __init__(self, name: str = ..., state: bool = ..., id: int = ..., parent: int = ...) -> None: ...

class IntParameter(genpy.Message):
    name: str
    value: int
    def __init__(self, name: str = ..., value: int = ...) -> None: ...

class ParamDescription(genpy.Message):
    name: str
    type: str
    level: int
    description: str
    edit_method: str
    def __init__(
        self, name: str = ..., type: str = ..., level: int = ..., description: str = ..., edit_method: str = ...
    ) -> None: ...

class StrParameter(genpy.Message):
    name: str
    value: str
    def __init__(self, name: str = ..., value: str = ...) -> None: ...
