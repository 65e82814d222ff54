"""Fiducials as fiducial_msgs has them, whose messages Debian does not package: made without building them."""

from __future__ import annotations

import functools
import importlib
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, overload

import genpy
import numpy as np
from genmsg import MsgContext
from genmsg.msg_loader import load_msg_from_string
from genpy.generator import msg_generator

from ur_nodes.codecs.codec import Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import stamp_of
from ur_nodes.codecs.geometry import pose3_of_transform, transform_message
from ur_nodes.ports.fiducials import (
    FiducialCorners,
    FiducialPose,
    MappedFiducial,
    MappedFiducials,
    SeenFiducials,
    StampedFiducials,
)

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


if TYPE_CHECKING:
    from fiducial_msgs.msg import FiducialArray, FiducialMapEntryArray, FiducialTransformArray

_SEEN, _CORNERS = message_classes("FiducialArray")
_PLACED, _POSE = message_classes("FiducialTransformArray")
_MAP, _ENTRY = message_classes("FiducialMapEntryArray")
_NAMES = tuple(f"{axis}{corner}" for corner in range(4) for axis in "xy")


def _fill_seen(message: FiducialArray, value: SeenFiducials) -> None:
    fill_header(message, value.stamp, value.frame)
    message.image_seq = value.picture
    message.fiducials = [_CORNERS(each.number, 0, *each.corners.ravel().tolist()) for each in value.fiducials]


def _seen_of(message: FiducialArray) -> SeenFiducials:
    return SeenFiducials(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.image_seq,
        tuple(
            FiducialCorners(each.fiducial_id, np.array([getattr(each, name) for name in _NAMES]).reshape(4, 2))
            for each in message.fiducials
        ),
    )


def _fill_placed(message: FiducialTransformArray, value: StampedFiducials) -> None:
    fill_header(message, value.stamp, value.frame)
    message.image_seq = value.picture
    message.transforms = [
        _POSE(each.number, transform_message(each.pose), each.image_error, each.object_error, each.area)
        for each in value.fiducials
    ]


def _placed_of(message: FiducialTransformArray) -> StampedFiducials:
    return StampedFiducials(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.image_seq,
        tuple(
            FiducialPose(
                each.fiducial_id,
                pose3_of_transform(each.transform),
                each.image_error,
                each.object_error,
                each.fiducial_area,
            )
            for each in message.transforms
        ),
    )


def _fill_map(message: FiducialMapEntryArray, value: MappedFiducials) -> None:
    message.fiducials = [
        _ENTRY(each.number, *each.position, *map(math.degrees, each.angles)) for each in value.fiducials
    ]


def _map_of(message: FiducialMapEntryArray) -> MappedFiducials:
    return MappedFiducials(
        tuple(
            MappedFiducial(
                each.fiducial_id,
                (each.x, each.y, each.z),
                (math.radians(each.rx), math.radians(each.ry), math.radians(each.rz)),
            )
            for each in message.fiducials
        )
    )


CODECS = {
    SeenFiducials: Codec(_SEEN, _fill_seen, _seen_of),
    StampedFiducials: Codec(_PLACED, _fill_placed, _placed_of),
    MappedFiducials: Codec(_MAP, _fill_map, _map_of),
}
