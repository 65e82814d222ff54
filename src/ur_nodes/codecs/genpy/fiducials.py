"""The messages of fiducial_msgs, which Debian does not package, without building them.

Where the package is installed, its own classes are used. Else they are made from the fields when they are needed; names
and fields (and so checksums) are those of upstream, so that nodes of either kind understand one another.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, overload

import genpy
from genmsg import MsgContext
from genmsg.msg_loader import load_msg_from_string
from genpy.generator import msg_generator

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
_FIELDS = {  # a message after those that it has
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
        made = make_classes(_PACKAGE, _FIELDS)
        return made[array], made[element]


def make_classes(package: str, fields: Mapping[str, str]) -> dict[str, type[genpy.Message]]:
    """Make the classes of a package's messages by their fields, in memory.

    A message stands after those that it has; those of other packages have their full names, and are installed.
    `genpy.dynamic` imports files instead, which a process that is killed leaves behind.
    """
    context, classes = MsgContext.create_default(), dict[str, type[genpy.Message]]()
    for name, definition in fields.items():
        full_name = name if "/" in name else f"{package}/{name}"
        spec = load_msg_from_string(context, f"{definition}\n", full_name)
        context.register(full_name, spec)
        if name != full_name:
            code = "\n".join(msg_generator(context, spec, {}))
            code = code.replace(f"import {package}.msg\n", "").replace(f"{package}.msg.", "")
            exec(code, classes)  # noqa: S102 - as genpy.dynamic does
    return classes
