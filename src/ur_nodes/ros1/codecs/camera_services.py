"""The services of cameras."""

from __future__ import annotations

from typing import Any

from sensor_msgs.srv import SetCameraInfo, SetCameraInfoRequest, SetCameraInfoResponse

from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Result
from ur_nodes.ros1.codecs.codec import ServiceCodec
from ur_nodes.ros1.codecs.pictures import calibration_of, fill_calibration


def _request(value: UseCalibration) -> Any:
    request = SetCameraInfoRequest()
    fill_calibration(request.camera_info, value.calibration)
    return request


SERVICES = {
    UseCalibration: ServiceCodec(
        SetCameraInfo,
        _request,
        lambda request: UseCalibration(calibration_of(request.camera_info)),
        lambda result: SetCameraInfoResponse(result.success, result.text),
        lambda response: Result(bool(response.success), str(response.status_message)),
    ),
}
