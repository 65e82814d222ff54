"""The services of cameras."""

from __future__ import annotations

from sensor_msgs.srv import SetCameraInfo

from ur_nodes.codecs.codec import ServiceCodec
from ur_nodes.codecs.dialect import parts_of
from ur_nodes.codecs.vision.pictures import calibration_of, fill_calibration
from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Result

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
    ),
}
