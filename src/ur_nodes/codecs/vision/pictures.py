"""Pictures, the calibration of their cameras, and the services of cameras."""

from __future__ import annotations

from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from sensor_msgs.srv import SetCameraInfo

from ur_nodes.codecs.codec import LARGE, Codec, ServiceCodec, fill_header, frame_of
from ur_nodes.codecs.dialect import ROS_2, bytes_of, number_of, parts_of, stamp_of
from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Calibration, PackedPicture, Picture, Result

_Request, _Response = parts_of(SetCameraInfo)


def _request(value: UseCalibration) -> SetCameraInfo.Request:
    request = _Request()
    fill_calibration(request.camera_info, value.calibration)
    return request


SERVICES = {
    UseCalibration: ServiceCodec(
        SetCameraInfo,
        _request,
        lambda request: UseCalibration(calibration_of(request.camera_info)),
        lambda result: _Response(success=result.success, status_message=result.text),
        lambda response: Result(bool(response.success), str(response.status_message)),
    )
}


_NUMBERS = "dkrp" if ROS_2 else "DKRP"  # the fields of a CameraInfo with distortion and matrices


def _fill_picture(message: Image, value: Picture) -> None:
    fill_header(message, value.stamp, value.frame)
    message.width, message.height, message.step = value.width, value.height, value.step
    message.encoding, message.data = value.encoding, value.data


def _picture_of(message: Image) -> Picture:
    return Picture(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.width,
        message.height,
        message.encoding,
        message.step,
        bytes_of(message.data),
        number_of(message),
    )


def _fill_packed(message: CompressedImage, value: PackedPicture) -> None:
    fill_header(message, value.stamp, value.frame)
    message.format, message.data = value.format, value.data


def _packed_of(message: CompressedImage) -> PackedPicture:
    stamp, number = stamp_of(message.header.stamp), number_of(message)
    return PackedPicture(stamp, frame_of(message), message.format, bytes_of(message.data), number)


def fill_calibration(message: CameraInfo, value: Calibration) -> None:
    """Write a sensor_msgs/CameraInfo."""
    fill_header(message, value.stamp, value.frame)
    message.width, message.height, message.distortion_model = value.width, value.height, value.model
    numbers = value.distortion, value.matrix, value.rectification, value.projection
    for name, each in zip(_NUMBERS, numbers, strict=True):
        setattr(message, name, each)


def calibration_of(message: CameraInfo) -> Calibration:
    """Read a sensor_msgs/CameraInfo."""
    return Calibration(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.width,
        message.height,
        message.distortion_model,
        *(tuple(map(float, getattr(message, name))) for name in _NUMBERS),
    )


CODECS = {
    Picture: Codec(Image, _fill_picture, _picture_of, LARGE),
    PackedPicture: Codec(CompressedImage, _fill_packed, _packed_of, LARGE),
    Calibration: Codec(CameraInfo, fill_calibration, calibration_of),
}
