"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import geometry_msgs.msg
import std_msgs.msg

class Fiducial(genpy.Message):
    fiducial_id: int
    direction: int
    x0: float
    y0: float
    x1: float
    y1: float
    x2: float
    y2: float
    x3: float
    y3: float
    def __init__(
        self,
        fiducial_id: int = ...,
        direction: int = ...,
        x0: float = ...,
        y0: float = ...,
        x1: float = ...,
        y1: float = ...,
        x2: float = ...,
        y2: float = ...,
        x3: float = ...,
        y3: float = ...,
    ) -> None: ...

class FiducialArray(genpy.Message):
    header: std_msgs.msg.Header
    image_seq: int
    fiducials: list[Fiducial]
    def __init__(
        self, header: std_msgs.msg.Header = ..., image_seq: int = ..., fiducials: list[Fiducial] = ...
    ) -> None: ...

class FiducialMapEntry(genpy.Message):
    fiducial_id: int
    x: float
    y: float
    z: float
    rx: float
    ry: float
    rz: float
    def __init__(
        self,
        fiducial_id: int = ...,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        rx: float = ...,
        ry: float = ...,
        rz: float = ...,
    ) -> None: ...

class FiducialMapEntryArray(genpy.Message):
    fiducials: list[FiducialMapEntry]
    def __init__(self, fiducials: list[FiducialMapEntry] = ...) -> None: ...

class FiducialTransform(genpy.Message):
    fiducial_id: int
    transform: geometry_msgs.msg.Transform
    image_error: float
    object_error: float
    fiducial_area: float
    def __init__(
        self,
        fiducial_id: int = ...,
        transform: geometry_msgs.msg.Transform = ...,
        image_error: float = ...,
        object_error: float = ...,
        fiducial_area: float = ...,
    ) -> None: ...

class FiducialTransformArray(genpy.Message):
    header: std_msgs.msg.Header
    image_seq: int
    transforms: list[FiducialTransform]
    def __init__(
        self, header: std_msgs.msg.Header = ..., image_seq: int = ..., transforms: list[FiducialTransform] = ...
    ) -> None: ...
