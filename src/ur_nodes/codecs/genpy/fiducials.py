"""The messages of fiducial_msgs, which Debian does not package, without building them.

Where the package is installed, its own classes are used. Else they are made from the fields when they are needed; names
and fields (and so checksums) are those of upstream, so that nodes of either kind understand one another.
"""

from __future__ import annotations

import functools
import importlib
from typing import TYPE_CHECKING, Literal, overload

import genpy
from genpy.dynamic import generate_dynamic

if TYPE_CHECKING:
    from fiducial_msgs.msg import (
        Fiducial,
        FiducialArray,
        FiducialMapEntry,
        FiducialMapEntryArray,
        FiducialTransform,
        FiducialTransformArray,
    )  # fmt: skip

_PACKAGE = "fiducial_msgs"
_HEADER = "std_msgs/Header"
_FIELDS = {
    _HEADER: "uint32 seq\ntime stamp\nstring frame_id",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
    "Fiducial": "int32 fiducial_id\nint32 direction\n"
    + "\n".join(f"float64 {axis}{corner}" for corner in range(4) for axis in "xy"),
    "FiducialArray": "std_msgs/Header header\nint32 image_seq\nfiducial_msgs/Fiducial[] fiducials",
    "FiducialTransform": "int32 fiducial_id\ngeometry_msgs/Transform transform\n"
    "float64 image_error\nfloat64 object_error\nfloat64 fiducial_area",
    "FiducialTransformArray": "std_msgs/Header header\nint32 image_seq\nFiducialTransform[] transforms",
    "FiducialMapEntry": "int32 fiducial_id\n" + "\n".join(f"float64 {n}" for n in ("x", "y", "z", "rx", "ry", "rz")),
    "FiducialMapEntryArray": "FiducialMapEntry[] fiducials",
}
_NEEDS = {
    "FiducialArray": (_HEADER, "Fiducial"),
    "FiducialTransformArray": (
        *(_HEADER, "FiducialTransform", "geometry_msgs/Transform"),
        *("geometry_msgs/Vector3", "geometry_msgs/Quaternion"),
    ),
    "FiducialMapEntryArray": ("FiducialMapEntry",),
}


@overload
def message_classes(array: Literal["FiducialArray"]) -> tuple[type[FiducialArray], type[Fiducial]]: ...
@overload
def message_classes(
    array: Literal["FiducialTransformArray"],
) -> tuple[type[FiducialTransformArray], type[FiducialTransform]]: ...
@overload
def message_classes(
    array: Literal["FiducialMapEntryArray"],
) -> tuple[type[FiducialMapEntryArray], type[FiducialMapEntry]]: ...
@overload
def message_classes(array: str) -> tuple[type[genpy.Message], type[genpy.Message]]: ...
def message_classes(array: str) -> tuple[type[genpy.Message], type[genpy.Message]]:
    """The class of an array message ("FiducialArray", ...) and that of its elements."""
    return _find_classes(array)


@functools.cache
def _find_classes(array: str) -> tuple[type[genpy.Message], type[genpy.Message]]:
    element = array.removesuffix("Array")
    try:
        installed = importlib.import_module(f"{_PACKAGE}.msg")
        return getattr(installed, array), getattr(installed, element)
    except (ImportError, AttributeError):
        pass
    separator = "\n" + "=" * 80 + "\n"
    parts = [_FIELDS[array] + "\n"]
    parts += [f"MSG: {name if '/' in name else f'{_PACKAGE}/{name}'}\n{_FIELDS[name]}\n" for name in _NEEDS[array]]
    made = generate_dynamic(f"{_PACKAGE}/{array}", separator.join(parts))
    return made[f"{_PACKAGE}/{array}"], made[f"{_PACKAGE}/{element}"]
