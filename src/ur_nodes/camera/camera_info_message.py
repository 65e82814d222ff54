"""Calibrations as messages."""

from __future__ import annotations

import math

from sensor_msgs.msg import CameraInfo

from ur_nodes.camera.calibration_file import MODELS, Calibration


def make_camera_info(calibration: Calibration | None, width: int, height: int, frame: str) -> CameraInfo:
    """The calibration as a message, with all matrices 0 where there is none (REP 104)."""
    message = CameraInfo(width=width, height=height)
    message.header.frame_id = frame
    if calibration is not None:
        message.distortion_model = calibration.model
        message.D, message.K = list(calibration.distortion), list(calibration.camera_matrix)
        message.R, message.P = list(calibration.rectification), list(calibration.projection)
    return message


def read_camera_info(message: CameraInfo, name: str) -> Calibration | str:
    """The calibration of a message, or why it cannot be one."""
    numbers = (*message.D, *message.K, *message.R, *message.P)
    if message.distortion_model not in MODELS:
        return f"distortion_model {message.distortion_model!r}, expected one of {', '.join(MODELS)}"
    if len(message.D) not in MODELS[message.distortion_model]:
        return f"{len(message.D)} numbers of distortion, expected {MODELS[message.distortion_model][0]}"
    if not all(map(math.isfinite, numbers)) or message.K[0] <= 0.0 or message.K[4] <= 0.0:
        return "a camera matrix K without focal lengths"
    return Calibration(
        name,
        message.width,
        message.height,
        message.distortion_model,
        tuple(message.D),
        tuple(message.K),
        tuple(message.R),
        tuple(message.P),
    )
