"""Pictures and calibrations as messages, to and from arrays."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import Point, Pose, Quaternion
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.rigid import Floats, to_quaternion
from ur_nodes.vision.detect import CameraModel

Pixels = npt.NDArray[np.uint8]
_CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1, "8UC1": 1, "8UC3": 3, "rgba8": 4, "bgra8": 4}


def read_image(message: Image) -> Pixels:
    """Rows from the top: grey (height, width) or red, green, blue (height, width, 3). Raises UserError."""
    channels = _CHANNELS.get(message.encoding)
    size = message.step * message.height
    if channels is None or len(message.data) < size or message.step < message.width * channels:
        raise UserError(
            error(
                f"an image of {len(message.data)} bytes, {message.width} x {message.height}, in encoding"
                f" {message.encoding!r}, expected one of {', '.join(_CHANNELS)}",
                rule="bad-image",
            )
        )
    rows = np.frombuffer(message.data, np.uint8, size).reshape(message.height, message.step)
    pixels = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
    if channels == 1:
        return np.ascontiguousarray(pixels[:, :, 0])
    colours = pixels[:, :, :3]
    return np.ascontiguousarray(colours[:, :, ::-1] if message.encoding.startswith("bgr") else colours)


def read_compressed(message: CompressedImage, *, grey: bool = False) -> Pixels:
    """As read_image, of a JPEG or PNG. Raises UserError."""
    data = np.frombuffer(message.data, np.uint8)
    found = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE if grey else cv2.IMREAD_COLOR) if data.size else None
    if found is None:
        text = f"a compressed image of {data.size} bytes ({message.format!r}), expected JPEG or PNG"
        raise UserError(error(text, rule="bad-image"))
    return np.asarray(found if grey else cv2.cvtColor(found, cv2.COLOR_BGR2RGB), np.uint8)


def make_image(pixels: Pixels, header: object) -> Image:
    """A message of an RGB picture (height, width, 3)."""
    height, width = pixels.shape[:2]
    return Image(header=header, height=height, width=width, encoding="rgb8", step=3 * width, data=pixels.tobytes())


def make_compressed(pixels: Pixels, header: object) -> CompressedImage:
    """A JPEG message of an RGB picture (height, width, 3)."""
    data = cv2.imencode(".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR))[1].tobytes()
    return CompressedImage(header=header, format="jpeg", data=data)


def read_camera(message: CameraInfo) -> CameraModel | None:
    """The calibration; None when the camera is not calibrated (REP 104: K is 0)."""
    if message.K[0] <= 0.0 or message.K[4] <= 0.0:
        return None
    distortion = np.asarray(message.D, np.float64) if len(message.D) in (4, 5, 8, 12, 14) else np.zeros(5)
    return CameraModel(np.asarray(message.K, np.float64).reshape(3, 3), distortion)


def pose_of(rigid: Floats) -> Pose:
    """A matrix (4, 4) as a geometry_msgs/Pose."""
    return Pose(Point(*rigid[:3, 3].tolist()), Quaternion(*to_quaternion(rigid)))
