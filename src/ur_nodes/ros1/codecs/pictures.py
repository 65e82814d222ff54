"""Pictures, and the calibration of their cameras."""

from __future__ import annotations

from typing import Any

from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from ur_nodes.ports.values import Calibration, PackedPicture, Picture
from ur_nodes.ros1.codecs.codec import LARGE, Codec, fill_header, frame_of, stamp_of


def _fill_picture(message: Any, value: Picture) -> None:
    fill_header(message, value.stamp, value.frame)
    message.width, message.height, message.step = value.width, value.height, value.step
    message.encoding, message.data = value.encoding, value.data


def _picture_of(message: Any) -> Picture:
    return Picture(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.width,
        message.height,
        message.encoding,
        message.step,
        message.data,
        message.header.seq,
    )


def _fill_packed(message: Any, value: PackedPicture) -> None:
    fill_header(message, value.stamp, value.frame)
    message.format, message.data = value.format, value.data


def _packed_of(message: Any) -> PackedPicture:
    stamp, number = stamp_of(message.header.stamp), message.header.seq
    return PackedPicture(stamp, frame_of(message), message.format, message.data, number)


def fill_calibration(message: Any, value: Calibration) -> None:
    """Write a sensor_msgs/CameraInfo."""
    fill_header(message, value.stamp, value.frame)
    message.width, message.height, message.distortion_model = value.width, value.height, value.model
    message.D, message.K, message.R, message.P = value.distortion, value.matrix, value.rectification, value.projection


def calibration_of(message: Any) -> Calibration:
    """Read a sensor_msgs/CameraInfo."""
    return Calibration(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.width,
        message.height,
        message.distortion_model,
        tuple(message.D),
        tuple(message.K),
        tuple(message.R),
        tuple(message.P),
    )


CODECS = {
    Picture: Codec(Image, _fill_picture, _picture_of, LARGE),
    PackedPicture: Codec(CompressedImage, _fill_packed, _packed_of, LARGE),
    Calibration: Codec(CameraInfo, fill_calibration, calibration_of),
}
