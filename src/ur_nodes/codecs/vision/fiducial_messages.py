"""Fiducials as fiducial_msgs has them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ur_nodes.codecs.codec import Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import stamp_of
from ur_nodes.codecs.genpy.fiducials import message_classes
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
