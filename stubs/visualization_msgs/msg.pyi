"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy
import geometry_msgs.msg
import sensor_msgs.msg
import std_msgs.msg

class Marker(genpy.Message):
    ARROW: int
    CUBE: int
    SPHERE: int
    CYLINDER: int
    LINE_STRIP: int
    LINE_LIST: int
    CUBE_LIST: int
    SPHERE_LIST: int
    POINTS: int
    TEXT_VIEW_FACING: int
    MESH_RESOURCE: int
    TRIANGLE_LIST: int
    ADD: int
    MODIFY: int
    DELETE: int
    DELETEALL: int
    ARROW_STRIP: int
    header: std_msgs.msg.Header
    ns: str
    id: int
    type: int
    action: int
    pose: geometry_msgs.msg.Pose
    scale: geometry_msgs.msg.Vector3
    color: std_msgs.msg.ColorRGBA
    lifetime: genpy.Duration
    frame_locked: bool
    points: list[geometry_msgs.msg.Point]
    colors: list[std_msgs.msg.ColorRGBA]
    text: str
    mesh_resource: str
    mesh_use_embedded_materials: bool
    texture_resource: str
    texture: sensor_msgs.msg.CompressedImage
    uv_coordinates: list[UVCoordinate]
    mesh_file: MeshFile
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        ns: str = ...,
        id: int = ...,
        type: int = ...,
        action: int = ...,
        pose: geometry_msgs.msg.Pose = ...,
        scale: geometry_msgs.msg.Vector3 = ...,
        color: std_msgs.msg.ColorRGBA = ...,
        lifetime: genpy.Duration = ...,
        frame_locked: bool = ...,
        points: list[geometry_msgs.msg.Point] = ...,
        colors: list[std_msgs.msg.ColorRGBA] = ...,
        text: str = ...,
        mesh_resource: str = ...,
        mesh_use_embedded_materials: bool = ...,
        texture_resource: str = ...,
        texture: sensor_msgs.msg.CompressedImage = ...,
        uv_coordinates: list[UVCoordinate] = ...,
        mesh_file: MeshFile = ...,
    ) -> None: ...

class MarkerArray(genpy.Message):
    markers: list[Marker]
    def __init__(self, markers: list[Marker] = ...) -> None: ...

class MeshFile(genpy.Message):
    filename: str
    data: bytes
    def __init__(self, filename: str = ..., data: bytes = ...) -> None: ...

class UVCoordinate(genpy.Message):
    u: float
    v: float
    def __init__(self, u: float = ..., v: float = ...) -> None: ...
